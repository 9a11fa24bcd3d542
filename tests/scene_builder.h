#pragma once
// Small problems for tests, built as the front end builds them: resolved Params and meshes.
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "model/model.h"

namespace mortise::testing {

inline Params vec(const Vec3& v) { return Params::make_list({Params::make_number(v[0]), Params::make_number(v[1]), Params::make_number(v[2])}); }

inline Params material(const std::string& model, double E, double nu, double density) {
  Params p = Params::make_table();
  p.set("model", Params::make_text(model));
  p.set("youngs_modulus", Params::make_number(E));
  p.set("poisson_ratio", Params::make_number(nu));
  p.set("density", Params::make_number(density));
  return p;
}

inline Params body_params(const Vec3& velocity = Vec3::Zero(), const Vec3& angular_velocity = Vec3::Zero(), bool self_contact = false) {
  Params p = Params::make_table();
  p.set("velocity", vec(velocity));
  p.set("angular_velocity", vec(angular_velocity));
  p.set("self_contact", Params::make_flag(self_contact));
  return p;
}

inline model::BodyInput soft_body(const std::string& name, const geometry::TetMesh& mesh, const Params& material, const Vec3& at = Vec3::Zero(),
                                  const Params& params = body_params()) {
  model::BodyInput b;
  b.name = name;
  b.type = model::BodyType::soft;
  model::set_mesh(b, mesh);
  for (Vec3& x : b.nodes) x += at;
  b.material = material;
  b.params = params;
  return b;
}

inline model::BodyInput stiff_body(const std::string& name, const geometry::TetMesh& mesh, const Params& material, const Vec3& at = Vec3::Zero(),
                                   const Params& params = body_params()) {
  model::BodyInput b;
  b.name = name;
  b.type = model::BodyType::stiff;
  const geometry::TriMesh surface = geometry::surface_of(mesh);
  b.nodes = surface.points;
  for (Vec3& x : b.nodes) x += at;
  b.triangles = surface.triangles;
  b.material = material;
  b.params = params;
  return b;
}

inline model::BodyInput half_space(const std::string& name, const Vec3& point, const Vec3& normal) {
  model::BodyInput b;
  b.name = name;
  b.type = model::BodyType::half_space;
  b.params.set("point", vec(point));
  b.params.set("normal", vec(normal));
  return b;
}

inline Params where_side(const std::string& side) {
  Params p = Params::make_table();
  p.set("side", Params::make_text(side));
  return p;
}

}  // namespace mortise::testing
