// mortar_contact on the faces of quadratic tetrahedra.
#include <gtest/gtest.h>

#include "base/error.h"
#include "contact_scene.h"
#include "effects/contact/barrier.h"
#include "geometry/midsides.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHat = 0.05, kKappa = 1e4;

Params params(const std::string& master, const std::string& gradient = "frozen", const std::string& quadrature = "3") {
  Params p = Params::make_table(), pair = Params::make_table(), pairs = Params::make_list();
  pair.set("slave", Params::make_text("pad"));
  pair.set("master", Params::make_text(master));
  pairs.push(pair);
  p.set("pairs", pairs);
  for (const auto& [key, value] : {std::pair{"d_hat", kHat}, {"stiffness", kKappa}, {"taper_width", 0.1}, {"guard", 0.0}, {"rest_share", 0.0}})
    p.set(key, Params::make_number(value));
  p.set("weights", Params::make_text("consistent"));
  p.set("quadrature", Params::make_text(quadrature));
  p.set("gradient", Params::make_text(gradient));
  p.set("gap", Params::make_text("pointwise"));
  p.set("two_pass", Params::make_flag(false));
  return p;
}

geometry::TetMesh block(Index cells) { return geometry::box({1, 1, 0.5}, std::array<Index, 3>{cells, cells, 1}); }

enum class Tool { linear, quadratic, stiff };

// A quadratic pad under a block of another mesh, `gap` apart.
model::ModelInput stack(double gap, Tool tool) {
  const Vec3 up(0, 0, 0.5 + gap);
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(soft_body("pad", geometry::with_midsides(block(2)), gel()));
  if (tool == Tool::stiff)
    in.bodies.push_back(stiff_body("tool", block(3), gel(), up));
  else
    in.bodies.push_back(soft_body("tool", tool == Tool::linear ? block(3) : geometry::with_midsides(block(3)), gel(), up));
  return in;
}

model::ModelInput on_floor(double gap) {
  model::ModelInput in;
  in.scene = Params::make_table();
  in.bodies.push_back(soft_body("pad", geometry::with_midsides(block(2)), gel()));
  in.bodies.push_back(half_space("floor", {0, 0, -0.25 - gap}, {0, 0, 1}));
  return in;
}

struct Problem {
  model::Model model;
  std::unique_ptr<fd::Subject> contact;
  Problem(model::ModelInput in, const Params& p) : model(std::move(in)), contact(make_effect("mortar_contact", p, model)) { contact->begin_step({}); }
};

void expect_derivatives(Problem& p, const fd::Vector& x) {
  const double h = 1e-5;
  const fd::Dense d = fd::effect_assemble(*p.contact, x, true);
  ASSERT_GT(d.gradient.norm(), 0);
  const auto E = [&](const fd::Vector& y) { return fd::effect_energy(*p.contact, y); };
  EXPECT_LT(fd::relative_error(d.gradient, fd::difference_gradient(E, x, h)), 1e-6);
  EXPECT_GT(fd::lowest_eigenvalue(d.hessian), -1e-12);
  for (unsigned seed = 1; seed <= 3; ++seed) {
    fd::Vector v = d.hessian * shaken(fd::Vector::Zero(x.size()), 1, seed);
    v /= v.cwiseAbs().maxCoeff();
    const auto at = [&](double a) { return E(x + a * h * v); };
    const double second = (-at(2) + 16 * at(1) - 30 * at(0) + 16 * at(-1) - at(-2)) / (12 * h * h);
    EXPECT_NEAR(second / v.dot(d.hessian * v), 1, 1e-5);
  }
}

// Uniform pressure p on the top (side 1) or bottom (-1) of the pad: nothing at corners, p A/3 per face at the middles of edges.
void expect_consistent(const Problem& p, const fd::Vector& gradient, double side) {
  const auto corners = static_cast<Index>(block(2).points.size());
  const auto rest = p.model.rest.download();
  const double pressure = kKappa * effects::barrier::phi(0.03 / kHat), face = 1.0 / 8;
  double total = 0;
  for (Index b = 0; b < p.model.bodies[0].block_end; ++b) {
    const double share = side * gradient[3 * b + 2] / (pressure * face / 3);
    if (b < corners) {
      EXPECT_NEAR(share, 0, 1e-10);
    } else if (side * rest[b][2] > 0.2499) {
      EXPECT_TRUE(std::abs(share - 1) < 1e-10 || std::abs(share - 2) < 1e-10) << share;
    }
    total += side * gradient[3 * b + 2];
  }
  EXPECT_NEAR(total / pressure, 1, 1e-12);
}

}  // namespace

TEST(MortarQuadratic, FrozenEnergyMatchesItsDerivatives) {
  for (const char* gradient : {"frozen", "exact"})
    for (Tool tool : {Tool::linear, Tool::quadratic, Tool::stiff}) {
      Problem p(stack(0.03, tool), params("tool", gradient));
      expect_derivatives(p, shaken(positions(p.model), 2e-3, 3));
    }
  Problem p(on_floor(0.03), params("floor"));
  expect_derivatives(p, shaken(positions(p.model), 2e-3, 3));
}

TEST(MortarQuadratic, UniformPressureLoadsMiddlesNotCorners) {
  for (Tool tool : {Tool::linear, Tool::quadratic, Tool::stiff}) {
    Problem p(stack(0.03, tool), params("tool"));
    expect_consistent(p, fd::effect_assemble(*p.contact, positions(p.model), false).gradient, 1);
  }
  Problem p(on_floor(0.03), params("floor"));
  expect_consistent(p, fd::effect_assemble(*p.contact, positions(p.model), false).gradient, -1);

  // and what is published and reported agrees
  Recorder r;
  p.contact->report(r);
  EXPECT_NEAR(r("mortar_contact/force_pad_z"), kKappa * effects::barrier::phi(0.03 / kHat), 1e-9);
  EXPECT_NEAR(r("mortar_contact/min_distance"), 0.03, 1e-12);
  const auto pressure = r.values.at("contact_pressure");
  EXPECT_NEAR(*std::max_element(pressure.begin(), pressure.end()), kKappa * effects::barrier::phi(0.03 / kHat), 1e-8);
}

// Also of bent faces, because the two points of a sample lie one above the other.
TEST(MortarQuadratic, ForcesBalance) {
  for (const char* gradient : {"frozen", "exact"})
    for (Tool tool : {Tool::linear, Tool::quadratic, Tool::stiff}) {
      Problem p(stack(0.03, tool), params("tool", gradient));
      for (double bow : {0.0, 2e-3}) {
        const fd::Vector x = shaken(positions(p.model), bow, 5);
        const fd::Dense d = fd::effect_assemble(*p.contact, x, false);
        ASSERT_GT(d.gradient.norm(), 0);
        const auto [force, moment] = resultant(p.model, x, d.gradient);
        EXPECT_LT(force.norm(), 1e-12 * d.gradient.norm());
        EXPECT_LT(moment.norm(), 1e-12 * d.gradient.norm());
      }
    }
}

// The gap is that between the quadratic faces: a middle node pushed towards the tool closes it, half-way to the corner by 3/4 of that.
TEST(MortarQuadratic, GapsFollowTheBow) {
  model::ModelInput in = stack(0.03, Tool::stiff);
  const auto corners = block(2).points.size();
  for (std::size_t i = corners; i < in.bodies[0].nodes.size(); ++i)
    if (in.bodies[0].nodes[i][2] > 0.2499) in.bodies[0].nodes[i][2] += 0.01;
  Problem p(std::move(in), params("tool", "frozen", "7"));
  Recorder r;
  p.contact->report(r);
  // z = 0.25 + 0.04 (l0 l1 + l1 l2 + l2 l0): 0.01 at the middles, 0.04/3 at the centres of the faces, from where samples are taken.
  EXPECT_NEAR(r("mortar_contact/min_distance"), 0.03 - 0.04 / 3, 1e-4);
}

// Middles of edges on both sides bow into each other, while corners and middles themselves keep apart: refused at the start.
TEST(MortarQuadratic, FacesThatMeetBetweenNodesAreRefused) {
  for (double bow : {0.02, 0.03}) {
    model::ModelInput in = stack(0.03, Tool::stiff);
    const auto corners = block(2).points.size();
    for (std::size_t i = corners; i < in.bodies[0].nodes.size(); ++i)
      if (in.bodies[0].nodes[i][2] > 0.2499) in.bodies[0].nodes[i][2] += 0.9999 * bow;
    if (bow < 0.03 * 3 / 4) {  // bow * 4/3 at the centre
      EXPECT_NO_THROW(Problem(std::move(in), params("tool")));
      continue;
    }
    try {
      Problem(std::move(in), params("tool", "frozen", "7"));
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("curved faces of 'pad' and 'tool' meet"), std::string::npos) << e.what();
    }
  }
}

TEST(MortarQuadratic, OnePointIsRefused) {
  model::Model m(stack(0.03, Tool::linear));
  try {
    make_effect("mortar_contact", params("tool", "frozen", "1"), m);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::scene);
    EXPECT_NE(std::string(e.what()).find("3, 6 or 7"), std::string::npos) << e.what();
  }
}
