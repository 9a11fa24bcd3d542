#include "engine/input.h"

#include "geometry/shapes.h"

namespace mortise::engine {
namespace {

// x -> R x + t, as the body's block says.
struct Placement {
  Mat3 R = Mat3::Identity();
  Vec3 t = Vec3::Zero();
  explicit Placement(const Params& body) : t(body.vec3("position")) {
    if (const Params* rotation = body.find("rotation"))
      R = Eigen::AngleAxisd(rotation->number("angle"), rotation->vec3("axis").normalized()).toRotationMatrix();
  }
  void apply(std::vector<Vec3>& points) const {
    for (Vec3& x : points) x = R * x + t;
  }
};

model::BodyInput make_body(const Params& scene, const std::string& name, const Params& body) {
  model::BodyInput out;
  out.name = name;
  out.params = body;
  const std::string& type = body.text("type");
  if (type == "half_space") {
    out.type = model::BodyType::half_space;
    return out;
  }
  out.material = scene.at("materials").at(body.text("material"));
  if (type == "soft") {
    out.type = model::BodyType::soft;
    model::set_mesh(out, geometry::tet_shape(body.at("shape"), {body.integer("order"), body.flag("curved")}));
  } else {
    out.type = model::BodyType::stiff;
    geometry::TriMesh mesh = geometry::surface_shape(body.at("shape"));
    out.nodes = std::move(mesh.points);
    out.triangles = std::move(mesh.triangles);
  }
  Placement(body).apply(out.nodes);
  return out;
}

}  // namespace

model::ModelInput make_input(const Params& scene) {
  model::ModelInput input;
  input.scene = scene;
  for (const auto& [name, body] : scene.at("bodies").entries()) {
    try {
      input.bodies.push_back(make_body(scene, name, body));
    } catch (const Error& e) {
      if (e.located()) throw;
      throw Error(e.code(), body.where(), "body '" + name + "': " + e.what());
    }
  }
  return input;
}

}  // namespace mortise::engine
