#pragma once
// Joints of stiff bodies x = p + A X as equations that are linear in their blocks (model/ties.h). At rest A = I, so that a direction of the scene
// is a material direction of both bodies. c follows t, Y and X are where the joint's place is in them, u is its axis (unit):
//
//     fixed       p_c = p_t + A_t X_c,   A_c = A_t                  X_c: the centre of c in t
//     spherical   p_c = p_t + A_t X - A_c Y
//     revolute    the same, and A_c u = A_t u, which gives the column of A_c where |u_i| is largest (then 1 / |u_i| <= sqrt 3):
//                 a_i = (A_t u - sum_{j != i} u_j a_j) / u_i
//     prismatic   A_c = A_t; its centre is guided along the axis by a support across it (model/joints.h), or by what it mimics:
//     mimic       and p_c = r p_a + (1 - r) p_t + A_t (X_c - r X_a):   r times the way of a, which slides on t along the same axis
//                 revolute: A_c = A_a, if a turns on t as far about the same direction. Others are no ties: equations.h
//
// In the world X is the place, A_t = I.
#include "effects/tie.h"

namespace mortise::effects::joint {

using Type = model::JointType;

// How `child` follows `parent` (model::Tie::kWorld: the world).
inline std::vector<model::Follow> follows(const model::Model& model, Type type, Index child, Index parent, const Vec3& place, const Vec3& u) {
  const model::Body& c = model.bodies[child];
  const Index a = c.block_begin + 1;  // first of the child's columns
  // A_t d
  const auto direction = [&](Index block, const Vec3& d) {
    model::Follow f{block, {}};
    if (parent == model::Tie::kWorld)
      f.fixed = d;
    else
      for (int k = 0; k < 3; ++k) f.terms.push_back({model.bodies[parent].block_begin + 1 + k, d[k]});
    return f;
  };
  std::vector<model::Follow> out;
  model::Follow p = material_point(model, parent, type == Type::fixed ? c.centre : place);
  p.block = c.block_begin;
  if (type == Type::prismatic) {
    for (int k = 0; k < 3; ++k) out.push_back(direction(a + k, Vec3::Unit(k)));
    return out;
  }
  if (type != Type::fixed) {
    const Vec3 Y = place - c.centre;
    for (int k = 0; k < 3; ++k) p.terms.push_back({a + k, -Y[k]});
  }
  out.push_back(std::move(p));
  if (type == Type::fixed)
    for (int k = 0; k < 3; ++k) out.push_back(direction(a + k, Vec3::Unit(k)));
  if (type == Type::revolute) {
    int i = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(u[k]) > std::abs(u[i])) i = k;
    model::Follow f = direction(a + i, u / u[i]);
    for (int j = 0; j < 3; ++j)
      if (j != i) f.terms.push_back({a + j, -u[j] / u[i]});
    out.push_back(std::move(f));
  }
  return out;
}

// The centre of `child`, `ratio` times as far as that of `leader` on the same `parent`.
inline model::Follow mimics(const model::Model& model, Index child, Index leader, Index parent, double ratio) {
  const model::Body &c = model.bodies[child], &a = model.bodies[leader];
  model::Follow f{c.block_begin, {{a.block_begin, ratio}}};
  if (parent == model::Tie::kWorld) {
    f.fixed = c.centre - ratio * a.centre;
    return f;
  }
  const model::Body& t = model.bodies[parent];
  const Vec3 d = c.centre - t.centre - ratio * (a.centre - t.centre);
  f.terms.push_back({t.block_begin, 1 - ratio});
  for (int k = 0; k < 3; ++k) f.terms.push_back({t.block_begin + 1 + k, d[k]});
  return f;
}

// The columns of `child`, which are those of `leader`; the place of the hinge stays as it is.
inline std::vector<model::Follow> turns_as(const model::Model& model, std::vector<model::Follow> hinge, Index child, Index leader) {
  std::vector<model::Follow> out{std::move(hinge.front())};
  for (int k = 0; k < 3; ++k) out.push_back({model.bodies[child].block_begin + 1 + k, {{model.bodies[leader].block_begin + 1 + k, 1}}});
  return out;
}

}  // namespace mortise::effects::joint
