// Estimates of the errors of quadratic elements (audit/stress_error.h, audit/pressure_error.h).
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "audit/pressure_error.h"
#include "audit/stress_error.h"
#include "geometry/midsides.h"
#include "geometry/primitives.h"
#include "geometry/quadratic.h"

using namespace mortise;

namespace {

model::ModelInput pad(const char* volumetric, int across = 2) {
  Params material = Params::make_table();
  material.set("youngs_modulus", Params::make_number(1e5)), material.set("poisson_ratio", Params::make_number(0.45));
  material.set("volumetric", Params::make_text(volumetric));
  model::BodyInput body;
  body.name = "pad", body.material = material;
  model::set_mesh(body, geometry::with_midsides(geometry::box(Vec3(4, 4, 1), {4, 4, across})));
  return {Params::make_table(), {body}};
}

std::vector<double> moved(const model::ModelInput& input, const std::function<Vec3(const Vec3&)>& u) {
  std::vector<double> out;
  for (const Vec3& x : input.bodies[0].nodes)
    for (int c = 0; c < 3; ++c) out.push_back(u(x)[c]);
  return out;
}

double stress_error(const char* volumetric, const std::function<Vec3(const Vec3&)>& u, int across = 2) {
  const model::ModelInput input = pad(volumetric, across);
  const audit::StressError estimate(input);
  return estimate.of(estimate.stresses(std::vector<double>(6 * input.bodies[0].tets.size(), NAN), moved(input, u)), {0}).error();
}

// Of the face z = 0.5, which a pressure p(x) loads: the consistent forces of the faces' pressure, or thirds of the quarters' areas.
double misfit(const std::function<double(const Vec3&)>& p, bool consistent) {
  const model::ModelInput input = pad("full");
  const model::BodyInput& body = input.bodies[0];
  std::vector<double> pressure(body.nodes.size(), 0.0), force(3 * body.nodes.size(), 0.0);
  const auto on_top = [&](Index v) { return body.nodes[v][2] > 0.49; };
  for (std::size_t i = 0; i < body.nodes.size(); ++i)
    if (on_top(static_cast<Index>(i))) pressure[i] = p(body.nodes[i]);
  if (consistent) {
    for (const geometry::Face& face : body.faces) {
      if (!on_top(face.v[0]) || !on_top(face.v[1]) || !on_top(face.v[2])) continue;
      // Exact to degree 4 (Dunavant, Int. J. Numer. Meth. Engng 21, 1985): six points.
      for (const auto& [a, w] : {std::pair{0.445948490915965, 0.223381589678011}, std::pair{0.091576213509771, 0.109951743655322}})
        for (int k = 0; k < 3; ++k) {
          double l[3] = {a, a, a}, N[6];
          Vec3 x = Vec3::Zero();
          l[k] = 1 - 2 * a;
          geometry::triangle_shape(l, N);
          for (int j = 0; j < 6; ++j) x += N[j] * body.nodes[face.v[j]];
          for (int j = 0; j < 6; ++j) force[3 * face.v[j] + 2] -= w * 0.5 * p(x) * N[j];  // half a square metre
        }
    }
  } else {
    for (const Triangle& t : body.triangles)
      if (on_top(t.v[0]) && on_top(t.v[1]) && on_top(t.v[2]))
        for (Index v : t.v) force[3 * v + 2] -= 0.125 / 3 * pressure[v];
  }
  return audit::PressureError(input).of({pressure, force, {}}).misfit;
}

}  // namespace

TEST(QuadraticError, LinearStressesAreNoErrorKinksAre) {
  const auto bend = [](const Vec3& x) { return Vec3(1e-6 * x[0] * x[2], 0, -0.5e-6 * x[0] * x[0]); };
  EXPECT_LT(stress_error("full", bend), 1e-9);
  EXPECT_GT(stress_error("averaged", bend), 1e-3) << "whose mean volumes jump from element to element";
  const auto turned = [](const Vec3& x) { return Vec3(-x[1] - x[0], x[0] - x[1], 0); };  // by a right angle
  const auto stretched = [&](const Vec3& x) { return Vec3(turned(x) + Vec3(0, 1e-3 * x[0], 0)); };
  EXPECT_LT(stress_error("full", stretched), 1e-9);
  EXPECT_LT(stress_error("averaged", stretched), 1e-9);
  const auto kink = [](const Vec3& x) { return Vec3(1e-6 * std::abs(x[0]), 0, 0); };
  EXPECT_GT(stress_error("full", kink), 0.1);
}

TEST(QuadraticError, WhatVariesWithinTheOnlyElementAcrossIsDoubtful) {
  const auto bend = [](const Vec3& x) { return Vec3(1e-6 * x[0] * x[2], 0, -0.5e-6 * x[0] * x[0]); };
  const auto stretch = [](const Vec3& x) { return Vec3(1e-6 * x[0], 0, 0); };
  EXPECT_GT(stress_error("full", bend, 1), 0.1);
  EXPECT_LT(stress_error("full", stretch, 1), 1e-9);
}

TEST(QuadraticError, ForcesThatNoPressureMakesAreSeen) {
  const auto even = [](const Vec3&) { return 1e3; };
  const auto slope = [](const Vec3& x) { return 1e3 + 200 * x[0] - 50 * x[1]; };
  EXPECT_LT(misfit(even, true), 1e-12);
  EXPECT_LT(misfit(slope, true), 1e-12);
  EXPECT_GT(misfit(even, false), 0.2) << "corners bear none of it";
}

TEST(QuadraticError, FacesThatReachBeyondThePatchSayNothing) {
  const auto half = [](const Vec3& x) { return x[0] < 0.6 ? 1e3 : 0; };
  EXPECT_LT(misfit(half, true), 1e-12);
}
