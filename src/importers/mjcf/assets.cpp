#include "importers/mjcf/assets.h"

#include <Eigen/Geometry>
#include <filesystem>

#include "geometry/rigid_motion.h"

namespace mortise::importers::mjcf {
namespace {

const Vec3 kGrey(0.5, 0.5, 0.5);  // of a geom that says nothing: MuJoCo's default
constexpr double kWater = 1000;   // density of a geom that says nothing [kg/m^3]: MuJoCo's default

Vec3 colour_of(const Element& e) {
  const std::vector<double> v = e.numbers("rgba", 4);
  return Vec3(v[0], v[1], v[2]).cwiseMax(0).cwiseMin(1);
}

Shape::Kind kind_of(const std::string& type) {
  return type == "sphere"     ? Shape::Kind::sphere
         : type == "cylinder" ? Shape::Kind::cylinder
         : type == "capsule"  ? Shape::Kind::capsule
         : type == "box"      ? Shape::Kind::box
                              : Shape::Kind::ellipsoid;
}

template <class Map>
std::vector<std::string> keys(const Map& map) {
  std::vector<std::string> out;
  for (const auto& [key, unused] : map) out.push_back(key);
  return out;
}

}  // namespace

void Assets::read(const Element& asset) {
  asset.expect({}, {"mesh", "material", "texture"}, {"hfield", "skin", "model"}, notes_);
  for (const Element& one : asset.children("texture")) {
    const Element e = defaults_.complete(one, "main");
    if (!e.has("file") || e.text("type", "cube") != "2d") {
      if (e.text("type", "cube") != "skybox") notes_.add(e.where(), "only textures of type 2d in files are imported");
      continue;
    }
    textures_[e.text("name", std::filesystem::path(e.text("file")).stem().string())] = compiler_.texture_file(e.text("file"));
  }
  for (const Element& e : asset.children("mesh")) mesh(defaults_.complete(e, "main"));
  for (const Element& one : asset.children("material")) {
    const Element e = defaults_.complete(one, "main");
    e.expect({"name", "class", "rgba", "texture"}, {},
             {"texrepeat", "texuniform", "emission", "specular", "shininess", "reflectance", "metallic", "roughness"}, notes_);
    if (e.has("rgba")) colours_[e.text("name")] = colour_of(e);
    if (!e.has("texture")) continue;
    if (const auto it = textures_.find(e.text("texture")); it != textures_.end()) painted_[e.text("name")] = it->second;
  }
}

void Assets::mesh(const Element& e) {
  e.expect({"name", "class", "file", "scale", "refpos", "refquat", "inertia", "smoothnormal", "maxhullvert", "content_type"}, {},
           {"vertex", "normal", "texcoord", "face", "builtin", "params", "material"}, notes_);
  if (!e.has("file")) e.fail("a <mesh> without 'file': only meshes in files are imported");
  Mesh m;
  m.file = compiler_.mesh_file(e.text("file"));
  if (std::filesystem::path(m.file).extension() == ".msh")
    e.fail("'" + e.text("file") + "' is in MuJoCo's own binary format; write it as OBJ or STL");
  m.scale = e.vector("scale", Vec3::Ones());
  if (m.scale.prod() == 0) e.fail("attribute 'scale' of <mesh> is zero");
  // MuJoCo: x -> scale R^T (x - t)
  const Pose seen{e.has("refquat") ? of_quaternion(e, "refquat") : Mat3::Identity(), e.vector("refpos", Vec3::Zero())};
  if (!(seen.R - Mat3::Identity()).isZero(1e-12) && !(m.scale.array() == m.scale[0]).all())
    e.fail("a mesh that 'refquat' turns can only have one 'scale' along all axes");
  m.at = seen.inverse();
  m.at.t = m.at.t.cwiseProduct(m.scale);
  const std::string name = e.text("name", std::filesystem::path(e.text("file")).stem().string());
  if (!meshes_.emplace(name, m).second) e.fail("a second mesh '" + name + "'");
}

std::optional<Shape> Assets::shape(const Element& g, const Pose& at) const {
  const std::string type = g.text("type", g.has("mesh") ? "mesh" : "sphere");
  for (const char* left_out : {"plane", "hfield", "sdf"})
    if (type == left_out) {
      notes_.add(g.where(), type == "plane" ? std::string("a <geom> that is a plane is left out: the scene has a floor of its own")
                                            : "a <geom> of type '" + type + "' is left out");
      return {};
    }
  Shape out;
  out.where = g.where();
  out.at = at * compiler_.pose(g);
  if (type == "mesh")
    of_mesh(g, out);
  else
    fill(g, type, out);
  out.contype = static_cast<int>(g.number("contype", 1.0)), out.conaffinity = static_cast<int>(g.number("conaffinity", 1.0));
  const int group = static_cast<int>(g.number("group", 0.0));
  if (compiler_.inertia != Compiler::Inertia::own && compiler_.groups[0] <= group && group <= compiler_.groups[1]) {
    if (g.has("mass"))
      out.mass = g.number("mass");
    else
      out.density = g.number("density", kWater);
    if (out.mass.value_or(0) < 0 || out.density.value_or(0) < 0) g.fail("a <geom> weighs less than nothing");
  }
  if (g.has("material") && !g.has_own("rgba"))
    if (const auto it = colours_.find(g.text("material")); it != colours_.end()) out.colour = it->second;
  if (g.has("material"))
    if (const auto it = painted_.find(g.text("material")); it != painted_.end()) out.texture = it->second;
  if (!out.colour) out.colour = g.has("rgba") ? colour_of(g) : kGrey;
  return out;
}

void Assets::of_mesh(const Element& g, Shape& out) const {
  const std::string name = g.text("mesh");
  const auto it = meshes_.find(name);
  if (it == meshes_.end()) g.fail(with_hint("there is no mesh '" + name + "'", name, keys(meshes_)));
  out.kind = Shape::Kind::mesh, out.file = it->second.file, out.scale = it->second.scale;
  out.at = out.at * it->second.at;
}

// Half sizes: a ball has one, cylinders and capsules two (half of the length without caps), boxes and ellipsoids three. With `fromto` the length is
// that between the two points, and z the way from one to the other.
void Assets::fill(const Element& g, const std::string& type, Shape& out) const {
  const bool ball = type == "sphere", round = type == "cylinder" || type == "capsule", boxy = type == "box" || type == "ellipsoid";
  if (!ball && !round && !boxy)
    g.fail(
        with_hint("a <geom> of type '" + type + "'", type, {"sphere", "capsule", "cylinder", "box", "ellipsoid", "mesh", "plane", "hfield", "sdf"}));
  if (g.has("mesh")) {
    of_mesh(g, out);
    out.fit_box = compiler_.fit_box, out.fit_scale = g.number("fitscale", 1.0);
    out.fit = kind_of(type);
    return;
  }
  std::vector<double> size = g.numbers("size");
  for (const double s : size)
    if (s < 0) g.fail("attribute 'size' of <geom> is below zero");
  size.resize(3, 0.0);
  Vec3 half(size[0], size[1], size[2]);
  if (g.has("fromto") && !ball)
    between(g, out, half);
  else if (round)
    half = {size[0], size[0], size[1]};
  if (!(half[0] > 0) || (!ball && half.minCoeff() <= 0)) g.fail("attribute 'size' of <geom> has too few numbers above zero for a " + type);
  out.radius = half[0];
  if (round) out.length = 2 * half[2];
  if (boxy) out.size = 2 * half;
  out.kind = kind_of(type);
}

void Assets::between(const Element& g, Shape& out, Vec3& half) const {
  const std::vector<double> p = g.numbers("fromto", 6);
  const Vec3 a(p[0], p[1], p[2]), b(p[3], p[4], p[5]);
  const Pose around = out.at * compiler_.pose(g).inverse();
  if (!((b - a).norm() > 0)) g.fail("the two points of 'fromto' are one");
  out.at = around * Pose{geometry::turn_of_z(b - a), 0.5 * (a + b)};
  half = {half[0], half[0], 0.5 * (b - a).norm()};
}

}  // namespace mortise::importers::mjcf
