#include "importers/robot/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "base/sha256.h"
#include "geometry/io/read.h"
#include "importers/robot/solid.h"
#include "importers/robot/write_aside.h"

namespace mortise::importers {
namespace {

namespace fs = std::filesystem;

const Vec3 kGrey{0.7, 0.7, 0.7};

double linear(double s) { return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4); }  // of sRGB

// OBJ and MTL of several visuals, in the frame of their body.
class Drawing {
 public:
  // `plain`: without materials, so that the body's own colour holds.
  explicit Drawing(bool plain) : plain_(plain) {}

  void add(const Shape& s, const Vec3& colour) {
    if (s.kind != Shape::Kind::mesh) {
      const geometry::TriMesh mesh = surface(s, s.at);
      use(colour, {}, "");
      for (const Vec3& x : mesh.points) point(x);
      const bool flat = s.kind == Shape::Kind::box || s.kind == Shape::Kind::cylinder;
      if (flat)
        for (const Triangle& t : mesh.triangles) {
          const Vec3 &a = mesh.points[t.v[0]], &b = mesh.points[t.v[1]], &c = mesh.points[t.v[2]];
          normal((b - a).cross(c - a).normalized());
        }
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
          obj_ += fmt::format("{}{}", k == 0 ? "f " : " ", points_ + mesh.triangles[t].v[k]);
          if (flat) obj_ += fmt::format("//{}", normals_ + static_cast<long>(t));
          if (k == 2) obj_ += "\n";
        }
      next(mesh.points.size(), 0, flat ? mesh.triangles.size() : 0);
      return;
    }
    geometry::VisualMesh mesh = geometry::read_visual(s.file);
    const bool mirrored = s.scale.prod() < 0;
    for (const Vec3& x : mesh.points) point(s.at(x.cwiseProduct(s.scale)));
    for (const Vec3& n : mesh.normals) normal((s.at.R * n.cwiseQuotient(s.scale)).normalized());
    if (mesh.has_uvs)
      for (const Vec2& t : mesh.uvs) fmt::format_to(std::back_inserter(obj_), "vt {:.7g} {:.7g}\n", t[0], t[1]);
    if (mesh.materials.empty()) mesh.materials.emplace_back();
    for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
      const geometry::VisualMaterial& material = mesh.materials[m];
      const bool painted = !s.texture.empty() && mesh.has_uvs && material.texture.file.empty();
      use(material.name.empty() && !painted ? colour
          : painted                         ? Vec3(Vec3::Ones())
                                            : material.base_color,
          material, painted ? s.texture : material.texture.file);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if ((mesh.material.empty() ? 0 : mesh.material[t]) != static_cast<Index>(m)) continue;
        Triangle corners = mesh.triangles[t];
        if (mirrored) std::swap(corners.v[1], corners.v[2]);
        face(corners, mesh.has_uvs, !mesh.normals.empty());
      }
    }
    next(mesh.points.size(), mesh.has_uvs ? mesh.uvs.size() : 0, mesh.normals.size());
  }

  // Called by what they hold: what one import writes no other replaces by something else.
  std::string write(const std::string& stem) const {
    fs::create_directories(fs::path(stem).parent_path());
    const std::string name = stem + "_" + sha256(mtl_ + obj_).substr(0, 8);
    if (plain_) return write_aside(name + ".obj", obj_);
    write_aside(name + ".mtl", mtl_);
    return write_aside(name + ".obj", "mtllib " + fs::path(name + ".mtl").filename().string() + "\n" + obj_);
  }

 private:
  void point(const Vec3& x) { fmt::format_to(std::back_inserter(obj_), "v {:.9g} {:.9g} {:.9g}\n", x[0], x[1], x[2]); }
  void normal(const Vec3& n) { fmt::format_to(std::back_inserter(obj_), "vn {:.5g} {:.5g} {:.5g}\n", n[0], n[1], n[2]); }
  // `colour`: linear.
  void use(const Vec3& colour, const geometry::VisualMaterial& m, const std::string& texture) {
    if (plain_) return;
    const std::string name = fmt::format("part_{}", parts_++);
    obj_ += "usemtl " + name + "\n";
    mtl_ += fmt::format("newmtl {}\nKd {:.6g} {:.6g} {:.6g}\nPr {:.6g}\nPm {:.6g}\n", name, colour[0], colour[1], colour[2], m.roughness, m.metallic);
    if (!texture.empty()) mtl_ += "map_Kd " + texture + "\n";
  }
  void face(const Triangle& t, bool uvs, bool normals) {
    obj_ += "f";
    for (const Index v : t.v) {
      obj_ += " " + std::to_string(points_ + v);
      if (uvs || normals) obj_ += "/";
      if (uvs) obj_ += std::to_string(uvs_ + v);
      if (normals) obj_ += "/" + std::to_string(normals_ + v);
    }
    obj_ += "\n";
  }
  void next(std::size_t points, std::size_t uvs, std::size_t normals) {
    points_ += static_cast<long>(points), uvs_ += static_cast<long>(uvs), normals_ += static_cast<long>(normals);
  }

  bool plain_;
  std::string obj_, mtl_;
  long points_ = 1, uvs_ = 1, normals_ = 1;  // OBJ counts from 1 over the whole file
  int parts_ = 0;
};

// Primitives of one colour that are those that touch.
bool seen_as_it_is(const Body& b) {
  if (b.visuals.empty()) return true;
  for (const Shape& s : b.visuals) {
    if (s.kind == Shape::Kind::mesh || (!b.one_colour && s.colour != b.visuals[0].colour)) return false;
    const auto same = [&](const Shape& o) {
      return o.kind == s.kind && o.size == s.size && o.radius == s.radius && o.length == s.length && o.at.R.isApprox(s.at.R) &&
             o.at.t.isApprox(s.at.t);
    };
    if (std::none_of(b.shapes.begin(), b.shapes.end(), same)) return false;
  }
  return b.visuals.size() == b.shapes.size();
}

void draw(Body& b, const std::string& folder) {
  if (seen_as_it_is(b)) return;
  if (b.visuals.size() == 1 && b.visuals[0].kind == Shape::Kind::mesh && b.visuals[0].even() && b.visuals[0].texture.empty()) {
    b.drawn = b.visuals[0];
    return;
  }
  Drawing all(b.one_colour);
  for (const Shape& s : b.visuals) {
    const Vec3 colour = s.colour.value_or(b.colour.value_or(kGrey));
    all.add(s, Vec3(linear(colour[0]), linear(colour[1]), linear(colour[2])));
  }
  Shape& drawn = b.drawn.emplace();
  drawn.kind = Shape::Kind::mesh, drawn.file = all.write(folder + "/" + b.name + "_visual");
}

}  // namespace

void draw_bodies(Machine& machine, const std::string& folder) {
  for (Body& b : machine.bodies) draw(b, folder);
}

}  // namespace mortise::importers
