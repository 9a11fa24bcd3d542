#include "engine/input.h"

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "base/complaints.h"
#include "effects/contact/named.h"
#include "effects/roles.h"
#include "geometry/bounds.h"
#include "geometry/placement.h"
#include "geometry/shapes.h"
#include "scene/scene.h"
#include "sensors/grid.h"

namespace mortise::engine {
namespace {

// Along a side of a stiff box that would have a single one and is not held as a whole. Faces with corners alone say little of where they press: on
// four of them a box resists being turned 1.85 times as much as one that is pressed evenly, with four cells 1.1 times; and cells of a stiff body
// take no degree of freedom. What is held is what others are pressed on, whose nodes tell where.
constexpr Index kStiffCells = 4;

// A body, and what else of the scene its mesh hangs on.
struct Wanted {
  const Params& body;
  Index single;
  Wanted(const Params& scene, const std::string& name, const Params& body) : body(body), single(body.text("type") == "stiff" ? kStiffCells : 1) {
    for (const Params* p : effects::of_body(scene.at("effects"), effects::Role::support, name))
      if (!p->has("release")) single = 1;
  }
};

// All that the mesh of a body hangs on.
std::string key_of(const Wanted& wanted) {
  const Params& body = wanted.body;
  Params of = Params::make_table();
  of.set("single", Params::make_number(wanted.single));
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
Mesh mesh_of(const std::map<std::string, Mesh>& there, const Wanted& wanted, const Make& make) {
  const auto it = there.empty() ? there.end() : there.find(key_of(wanted));
  return it != there.end() ? it->second : make(wanted);
}

template <class Mesh, class Make>
void keep(std::map<std::string, Mesh>& there, const Wanted& wanted, const Make& make) {
  if (std::string key = key_of(wanted); !there.count(key)) there.emplace(std::move(key), make(wanted));
}

geometry::TetMesh soft_mesh(const Wanted& wanted) {
  const Params& body = wanted.body;
  return geometry::tet_shape(body.at("shape"), {body.integer("order"), body.flag("curved")});
}
geometry::TriMesh stiff_mesh(const Wanted& wanted) { return geometry::surface_shape(wanted.body.at("shape"), wanted.single); }

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
  const Wanted wanted(scene, name, body);
  if (type == "soft") {
    out.type = model::BodyType::soft;
    model::set_mesh(out, mesh_of(kept().soft, wanted, soft_mesh));
  } else {
    out.type = model::BodyType::stiff;
    geometry::TriMesh mesh = mesh_of(kept().stiff, wanted, stiff_mesh);
    out.nodes = std::move(mesh.points);
    out.triangles = std::move(mesh.triangles);
  }
  geometry::Placement(body).apply(out.nodes);
  if (const Params* sensors = type == "stiff" ? scene.find("sensors") : nullptr)
    for (const auto& [sensor, p] : sensors->entries())
      if (p.text("body") == name) sensors::refine(out, sensors::grid_of(p));
  return out;
}

// In a layer thicker than a body everything is near everything: the first step takes hours and fills the memory.
void check_layers(const model::ModelInput& input) {
  constexpr double kMost = 0.5;  // of the size of a body
  const Params& effects = input.scene.at("effects");
  for (const std::string& name : effects::of_role(effects, effects::Role::contact)) {
    const Params *d_hat = effects.at(name).find("d_hat"), *pairs = effects.at(name).find("pairs");
    const std::set<std::string> listed = pairs ? effects::contact::named(*pairs) : std::set<std::string>();
    const model::BodyInput* smallest = nullptr;
    double size = INFINITY;
    for (const model::BodyInput& body : input.bodies) {
      if (!d_hat || body.nodes.empty() || (pairs && !listed.count(body.name))) continue;
      if (const double s = geometry::bounds_of(body.nodes).size().maxCoeff(); s < size) size = s, smallest = &body;
    }
    if (!smallest || d_hat->as_number() <= kMost * size) continue;
    std::ostringstream text;
    text << "effects." << name << ".d_hat is " << d_hat->as_number() << " m, more than half of body '" << smallest->name << "', which is " << size
         << " m large: contact would keep bodies that far apart";
    throw Error(Exit::scene, d_hat->where(), text.str());
  }
}

}  // namespace

void keep_meshes(const Params& scene) {
  for (const auto& [name, body] : scene.at("bodies").entries()) {
    const Wanted wanted(scene, name, body);
    if (body.text("type") == "soft") keep(kept().soft, wanted, soft_mesh);
    if (body.text("type") == "stiff") keep(kept().stiff, wanted, stiff_mesh);
  }
}

model::ModelInput make_input(const Params& scene) {
  model::ModelInput input;
  input.scene = scene;
  Complaints wrong;
  for (const auto& [name, body] : scene.at("bodies").entries())
    wrong.gather([&] {
      try {
        input.bodies.push_back(make_body(scene, name, body));
      } catch (const Error& e) {
        if (e.located()) throw;
        throw Error(e.code(), body.where(), "body '" + name + "': " + e.what());
      }
    });
  wrong.raise();
  check_layers(input);
  return input;
}

}  // namespace mortise::engine
