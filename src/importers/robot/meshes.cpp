#include "importers/robot/meshes.h"

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>
#include <utility>

#include "geometry/hull.h"
#include "geometry/io/obj.h"
#include "geometry/topology_check.h"
#include "importers/robot/names.h"
#include "importers/robot/solid.h"
#include "importers/robot/write_aside.h"

namespace mortise::importers {
namespace {

namespace fs = std::filesystem;

// More than a link's contact is worth: its hull does as well, and costs less.
constexpr std::size_t kMostTriangles = 5000;

bool is_file(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored);
}

// Where package://NAME/rest may be.
std::vector<fs::path> candidates(const std::string& package, const fs::path& rest, const Robot& robot, const MeshOptions& options) {
  if (const auto it = options.packages.find(package); it != options.packages.end()) return {fs::path(it->second) / rest};
  std::vector<fs::path> out;
  for (fs::path folder = fs::absolute(robot.path).lexically_normal().parent_path(); !folder.empty(); folder = folder.parent_path()) {
    if (folder.filename() == package) out.push_back(folder / rest);
    out.push_back(folder / package / rest);
    if (folder == folder.root_path()) break;
  }
  if (const char* listed = std::getenv("ROS_PACKAGE_PATH")) {
    std::istringstream folders(listed);
    for (std::string folder; std::getline(folders, folder, ':');)
      if (!folder.empty()) {
        if (fs::path(folder).filename() == package) out.push_back(fs::path(folder) / rest);
        out.push_back(fs::path(folder) / package / rest);
      }
  }
  return out;
}

// The file behind a name; empty where there is none.
std::string found(const std::string& name, const Robot& robot, const MeshOptions& options) {
  const auto behind = [&](const std::string& scheme) { return name.rfind(scheme, 0) == 0 ? name.substr(scheme.size()) : std::string(); };
  for (const char* scheme : {"package://", "model://"})
    if (const std::string uri = behind(scheme); !uri.empty()) {
      const std::size_t slash = uri.find('/');
      if (slash == std::string::npos) return "";
      for (const fs::path& file : candidates(uri.substr(0, slash), uri.substr(slash + 1), robot, options))
        if (is_file(file)) return file.string();
      return "";
    }
  const std::string path = behind("file://").empty() ? name : behind("file://");
  const fs::path file = fs::path(path).is_absolute() ? fs::path(path) : fs::absolute(robot.path).parent_path() / path;
  return is_file(file) ? file.lexically_normal().string() : "";
}

// Who has only some of a robot's files has them in one folder.
std::string beside(const std::string& name, const Robot& robot) {
  const fs::path file = fs::absolute(robot.path).parent_path() / fs::path(name).filename();
  return is_file(file) ? file.lexically_normal().string() : "";
}

}  // namespace

void find_meshes(Robot& robot, const MeshOptions& options, Notes& notes) {
  for (Link& link : robot.links)
    for (std::vector<Shape>* shapes : {&link.visuals, &link.collisions})
      for (Shape& s : *shapes) {
        if (s.texture.empty()) continue;
        std::string file = found(s.texture, robot, options);
        if (file.empty()) file = beside(s.texture, robot);
        if (file.empty()) notes.add(s.where, "the picture of a texture, '" + s.texture + "', is not there: it is left out");
        s.texture = file;
      }
  std::vector<const Shape*> missing;
  for (Link& link : robot.links)
    for (std::vector<Shape>* shapes : {&link.visuals, &link.collisions})
      for (Shape& s : *shapes) {
        if (s.kind != Shape::Kind::mesh) continue;
        std::string file = found(s.file, robot, options);
        if (file.empty())
          if (file = beside(s.file, robot); !file.empty())
            notes.add(s.where, "a mesh is not where the file says; the one of its name beside the robot's file is taken");
        if (file.empty())
          missing.push_back(&s);
        else
          s.file = file;
      }
  if (missing.empty()) return;
  if (!options.skip_missing) {
    const std::string& name = missing[0]->file;
    const bool package = name.rfind("package://", 0) == 0;
    throw Error(Exit::file, missing[0]->where,
                "there is no mesh '" + name + "'" +
                    (missing.size() > 1 ? ", nor " + std::to_string(missing.size() - 1) + " more that the robot names" : "") +
                    (package ? options.where(name.substr(10, name.find('/', 10) - 10)) : "") + options.skip_hint);
  }
  for (Link& link : robot.links)
    for (std::vector<Shape>* shapes : {&link.visuals, &link.collisions})
      std::erase_if(*shapes, [&](const Shape& s) {
        if (s.kind != Shape::Kind::mesh || is_file(s.file)) return false;
        if (!link.colour) link.colour = s.colour;
        link.undrawn = link.undrawn || shapes == &link.visuals;
        notes.add(s.where, std::string(shapes == &link.visuals ? "a visual" : "a collision") + " mesh is missing and left out");
        return true;
      });
}

static bool closed(const geometry::TriMesh& mesh) {
  try {
    geometry::check_closed_surface(mesh, "");
    return true;
  } catch (const Error&) {
    return false;
  }
}

static geometry::TriMesh turned_round(geometry::TriMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}

static void scale(geometry::TriMesh& mesh, const Vec3& by) {
  for (Vec3& x : mesh.points) x = x.cwiseProduct(by);
}

void mend_collision_meshes(Robot& robot, const MeshOptions& options, Notes& notes) {
  for (Link& link : robot.links)
    for (std::size_t i = 0; i < link.collisions.size(); ++i) {
      Shape& s = link.collisions[i];
      const auto write = [&](const geometry::TriMesh& surface) {
        fs::create_directories(options.folder);
        const std::string number = link.collisions.size() > 1 ? "_" + std::to_string(i) : "";
        s.file = write_aside(options.folder + "/" + scene_name(link.name) + number + ".obj", geometry::obj_text(surface));
        s.surface = std::make_shared<const geometry::TriMesh>(surface), s.kind = Shape::Kind::mesh, s.scale = Vec3::Ones();
      };
      if (s.kind == Shape::Kind::ellipsoid) {
        write(surface(s, Pose{}));
        continue;
      }
      if (s.kind != Shape::Kind::mesh) continue;
      robot.read_surface(s);
      geometry::TriMesh mesh = *s.surface;
      std::string why;
      if (!s.even()) {
        why = "is scaled or mirrored along single axes";
      } else if (mesh.triangles.size() > kMostTriangles) {
        why = "has more than " + std::to_string(kMostTriangles) + " triangles";
      } else if (closed(mesh)) {
        continue;
      } else if (geometry::TriMesh turned = turned_round(mesh); closed(turned)) {
        scale(turned, s.scale);
        write(turned);
        notes.add(s.where, "a collision mesh is inside out: its triangles are turned round");
        continue;
      } else {
        why = "is no closed surface without self-intersections";
      }
      scale(mesh, s.scale);
      geometry::TriMesh hull;
      try {
        hull = geometry::convex_hull(mesh.points);
      } catch (const Error& e) {
        throw Error(e.code(), s.where, "mesh '" + s.file + "' " + why + ", and has no convex hull: " + e.what());
      }
      write(hull);
      notes.add(s.where, "a collision mesh " + why + ": its convex hull takes its place");
    }
}

}  // namespace mortise::importers
