#include "importers/urdf/meshes.h"

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>

#include "geometry/hull.h"
#include "geometry/io/obj.h"
#include "geometry/io/read.h"
#include "geometry/topology_check.h"

namespace mortise::importers::urdf {
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

// The file behind a name of a URDF; empty where there is none.
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

std::string without_location(const Error& e) {
  const std::string text = e.what();
  const std::size_t at = text.find(": error: ");
  return at == std::string::npos ? text : text.substr(at + 9);
}

}  // namespace

void find_meshes(Robot& robot, const MeshOptions& options, Notes& notes) {
  std::vector<const Shape*> missing;
  for (Link& link : robot.links)
    for (std::vector<Shape>* shapes : {&link.visuals, &link.collisions})
      for (Shape& s : *shapes) {
        if (s.kind != Shape::Kind::mesh) continue;
        const std::string file = found(s.file, robot, options);
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
        notes.add(s.where, std::string(shapes == &link.visuals ? "a visual" : "a collision") + " mesh is missing and left out");
        return true;
      });
}

void mend_collision_meshes(Robot& robot, const MeshOptions& options, Notes& notes) {
  for (Link& link : robot.links)
    for (std::size_t i = 0; i < link.collisions.size(); ++i) {
      Shape& s = link.collisions[i];
      if (s.kind != Shape::Kind::mesh) continue;
      geometry::TriMesh mesh;
      try {
        mesh = geometry::read_surface(s.file);
      } catch (const Error& e) {
        throw Error(e.code(), s.where, "mesh '" + s.file + "' cannot be read: " + without_location(e));
      }
      std::string why;
      if (!s.even()) {
        why = "is scaled or mirrored along single axes";
      } else if (mesh.triangles.size() > kMostTriangles) {
        why = "has more than " + std::to_string(kMostTriangles) + " triangles";
      } else {
        try {
          geometry::check_closed_surface(mesh, "");
          continue;
        } catch (const Error&) {
          why = "is no closed surface without self-intersections";
        }
      }
      for (Vec3& x : mesh.points) x = x.cwiseProduct(s.scale);
      geometry::TriMesh hull;
      try {
        hull = geometry::convex_hull(mesh.points);
      } catch (const Error& e) {
        throw Error(e.code(), s.where, "mesh '" + s.file + "' " + why + ", and has no convex hull: " + e.what());
      }
      fs::create_directories(options.folder);
      const std::string file = options.folder + "/" + link.name + (link.collisions.size() > 1 ? "_" + std::to_string(i) : "") + ".obj";
      geometry::write_obj(file, hull);
      notes.add(s.where, "a collision mesh " + why + ": its convex hull takes its place");
      s.file = fs::absolute(file).lexically_normal().string(), s.scale = Vec3::Ones();
    }
}

}  // namespace mortise::importers::urdf
