#include "engine/input.h"

#include <map>

#include "geometry/placement.h"
#include "geometry/shapes.h"
#include "scene/scene.h"

namespace mortise::engine {
namespace {

// All that the mesh of a body hangs on.
std::string key_of(const Params& body) {
  Params of = Params::make_table();
  for (const char* key : {"shape", "order", "curved"})
    if (const Params* value = body.find(key)) of.set(key, *value);
  return scene::to_yaml(of);
}

// By the text of what they were made from.
struct Meshes {
  std::map<std::string, geometry::TetMesh> soft;
  std::map<std::string, geometry::TriMesh> stiff;
};
Meshes& kept() {
  static Meshes meshes;
  return meshes;
}

template <class Mesh, class Make>
Mesh mesh_of(const std::map<std::string, Mesh>& there, const Params& body, const Make& make) {
  const auto it = there.empty() ? there.end() : there.find(key_of(body));
  return it != there.end() ? it->second : make(body);
}

geometry::TetMesh soft_mesh(const Params& body) { return geometry::tet_shape(body.at("shape"), {body.integer("order"), body.flag("curved")}); }
geometry::TriMesh stiff_mesh(const Params& body) { return geometry::surface_shape(body.at("shape")); }

model::BodyInput make_body(const Params& scene, const std::string& name, const Params& body) {
  model::BodyInput out;
  out.name = name;
  out.params = body;
  const std::string& type = body.text("type");
  if (type == "half_space") {
    out.type = model::BodyType::half_space;
    return out;
  }
  if (body.has("material")) out.material = scene.at("materials").at(body.text("material"));  // a stiff one of stated mass may have none
  if (type == "soft") {
    out.type = model::BodyType::soft;
    model::set_mesh(out, mesh_of(kept().soft, body, soft_mesh));
  } else {
    out.type = model::BodyType::stiff;
    geometry::TriMesh mesh = mesh_of(kept().stiff, body, stiff_mesh);
    out.nodes = std::move(mesh.points);
    out.triangles = std::move(mesh.triangles);
  }
  geometry::Placement(body).apply(out.nodes);
  return out;
}

}  // namespace

void keep_meshes(const Params& scene) {
  for (const auto& [name, body] : scene.at("bodies").entries()) {
    if (body.text("type") == "soft") kept().soft.try_emplace(key_of(body), soft_mesh(body));
    if (body.text("type") == "stiff") kept().stiff.try_emplace(key_of(body), stiff_mesh(body));
  }
}

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
