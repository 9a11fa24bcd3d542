// The contact patch test through the whole chain: two blocks with non-matching
// meshes, uniform pressure; every stress must be that of uniaxial compression, sigma_zz = -p and nothing else.
#include <cstdio>

#include "effects/contact/barrier.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

struct Patch {
  double d_hat = 1e-2, kappa = 1e6, nu = 0.3;
  std::string slave = "bottom", weights = "consistent", quadrature = "3", gradient = "frozen";
  bool two_pass = false;
  double bottom_side = 1, top_side = 1;           // squares that share the corner at the origin
  double bottom_edge = 0.25, top_edge = 1.0 / 6;  // mesh sizes: 4 and 6 cells
  int bottom_order = 1, top_order = 1;
};

std::string num(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", v);
  return text;
}

std::string block(const std::string& name, double side, double edge, double z, int order) {
  return "  " + name + ": {type: soft, order: " + std::to_string(order) + ", shape: {box: {size: [" + num(side) + ", " + num(side) +
         ", 0.5], edge_length: " + num(edge) + "}}, material: rubber, position: [" + num(side / 2) + ", " + num(side / 2) + ", " + num(z) + "]}\n";
}

// The part of the larger square that the smaller one leaves bare, as two rectangles at height z.
std::string bare(const std::string& body, double small, double large, double z) {
  const auto part = [&](double x0, double x1, double y0, double y1) {
    return "    - {body: " + body + ", where: {box: {min: [" + num(x0 - 1e-6) + ", " + num(y0 - 1e-6) + ", " + num(z - 1e-6) + "], max: [" +
           num(x1 + 1e-6) + ", " + num(y1 + 1e-6) + ", " + num(z + 1e-6) + "]}}, pressure: 1 kPa}\n";
  };
  return part(small, large, 0, large) + part(0, small, small, large);
}

struct Result {
  double szz = 0, spurious = 0, pressure = 0, partition = 0, guard = 0, balance = 0;
  long newton = 0;
};

Result run(const Patch& c) {
  const double gap = 0.5 * c.d_hat, h = 0.5;
  std::string loads = "    - {body: top, where: {side: z_max}, pressure: 1 kPa}\n";
  if (c.top_side < c.bottom_side) loads += bare("bottom", c.top_side, c.bottom_side, h);
  if (c.top_side > c.bottom_side) loads += bare("top", c.bottom_side, c.top_side, h + gap);
  Rig rig(
      "mortise: 1\nname: patch\ntime: {mode: static, steps: 1}\nmaterials:\n  rubber: {model: linear, youngs_modulus: 1 MPa, "
      "poisson_ratio: " +
      num(c.nu) + ", density: 1000}\nbodies:\n" + block("bottom", c.bottom_side, c.bottom_edge, h / 2, c.bottom_order) +
      block("top", c.top_side, c.top_edge, 1.5 * h + gap, c.top_order) +
      "effects:\n  elasticity: {}\n  pin:\n    - {body: bottom, where: {side: z_min}, axes: z}\n    - {body: bottom, where: "
      "{side: x_min}, axes: x}\n"
      "    - {body: bottom, where: {side: y_min}, axes: y}\n    - {body: top, where: {side: x_min}, axes: x}\n    - {body: top, "
      "where: {side: y_min}, axes: y}\n"
      "  pressure_load:\n" +
      loads + "  mortar_contact:\n    pairs: [{slave: " + c.slave + ", master: " + (c.slave == "top" ? "bottom" : "top") +
      "}]\n    d_hat: " + num(c.d_hat) + "\n    stiffness: " + num(c.kappa) + "\n    weights: " + c.weights + "\n    quadrature: " + c.quadrature +
      "\n    gradient: " + c.gradient + "\n    two_pass: " + (c.two_pass ? "true" : "false") +
      "\nsolver: {relative_tolerance: 1e-13, force_tolerance: 0}\n");
  Result r;
  r.newton = rig.step().newton;
  const Captured f = rig.fields();
  const auto judge = [&](const std::vector<double>& stress) {
    for (std::size_t i = 0; i < stress.size(); ++i) {
      double& worst = i % 6 == 2 ? r.szz : r.spurious;
      worst = std::max(worst, std::abs(stress[i] / 1e3 + (i % 6 == 2 ? 1 : 0)));
    }
  };
  judge(f.cell.at("cauchy_stress"));
  if (c.bottom_order + c.top_order > 2) judge(f.row.at("elasticity/point_stress"));
  for (double p : f.row.at("mortar_contact/pressure")) r.pressure = std::max(r.pressure, std::abs(p / 1e3 - 1));
  r.partition = f.at("mortar_contact/clip_partition_defect");
  r.guard = f.at("mortar_contact/force_share_guard");
  r.balance = 0;
  for (const char* axis : {"x", "y", "z"})
    r.balance = std::max(r.balance,
                         std::abs(f.at(std::string("mortar_contact/force_top_") + axis) + f.at(std::string("mortar_contact/force_bottom_") + axis)));
  const double side = std::min(c.bottom_side, c.top_side);
  // Positions of about 1 m are known to 2e-16 m, so forces are to that times the stiffness of the layer.
  const double t = effects::barrier::phi_inverse(1e3 / c.kappa), layer = c.kappa * effects::barrier::second(t * c.d_hat, c.d_hat);
  // The more nodes, the larger the sum of what rounding leaves at each.
  EXPECT_NEAR(f.at("mortar_contact/force_top_z"), 1e3 * side * side, (c.bottom_order + c.top_order > 2 ? 1e-6 : 1e-7) + 2e-16 * layer * side * side);
  std::printf("  d_hat %.0e kappa %.0e nu %.2f %s %s q%s %s%s %g/%g: szz %.1e spurious %.1e, %ld iterations\n", c.d_hat, c.kappa, c.nu,
              c.slave.c_str(), c.weights.c_str(), c.quadrature.c_str(), c.gradient.c_str(), c.two_pass ? " two-pass" : "", c.bottom_side, c.top_side,
              r.szz, r.spurious, r.newton);
  return r;
}

void expect_passes(const Patch& c, double tolerance = 1e-10) {
  const Result r = run(c);
  EXPECT_LE(r.szz, tolerance);
  EXPECT_LE(r.spurious, tolerance);
  EXPECT_LE(r.partition, 1e-12);
  EXPECT_LE(r.balance, 1e-10);
}

}  // namespace

TEST(MortarPatch, PassesOnBothSides) {
  for (const char* slave : {"bottom", "top"}) {
    Patch c;
    c.slave = slave;
    expect_passes(c);
  }
  Patch c;
  c.two_pass = true;
  expect_passes(c);
}

// Uniform gap makes uniform pressure whatever the barrier: eight decades of kappa, three of d_hat.
TEST(MortarPatch, PassesForEveryStiffnessAndRange) {
  for (double d_hat : {1e-2, 1e-3, 1e-4, 1e-5})
    for (double kappa : {1e3, 1e5, 1e7, 1e9, 1e11}) {
      Patch c;
      c.d_hat = d_hat, c.kappa = kappa;
      expect_passes(c);
    }
}

TEST(MortarPatch, PassesForEveryRuleAndGradient) {
  for (const char* quadrature : {"1", "6", "7"}) {
    Patch c;
    c.quadrature = quadrature;
    expect_passes(c);
  }
  Patch c;
  c.gradient = "exact";
  expect_passes(c);
}

TEST(MortarPatch, PassesForEveryPoissonRatio) {
  for (double nu : {0.0, 0.45, 0.49}) {
    Patch c;
    c.nu = nu;
    expect_passes(c);
  }
}

// One block stands over the other's edge; both bare parts are loaded.
TEST(MortarPatch, PassesWithOverhang) {
  for (const char* slave : {"bottom", "top"})
    for (bool top_is_smaller : {true, false}) {
      Patch c;
      c.slave = slave;
      (top_is_smaller ? c.top_side : c.bottom_side) = 0.5;
      c.bottom_edge = top_is_smaller ? 1.0 / 6 : 0.125, c.top_edge = top_is_smaller ? 0.125 : 1.0 / 6;
      expect_passes(c);
      c.two_pass = true;
      expect_passes(c);
    }
}

// Quadratic tetrahedra, on both sides or against linear ones: stresses at every point of integration.
TEST(MortarPatch, PassesWithQuadraticTetrahedra) {
  for (const auto& [bottom, top] : {std::pair{2, 2}, std::pair{2, 1}, std::pair{1, 2}})
    for (const char* slave : {"bottom", "top"}) {
      Patch c;
      c.bottom_order = bottom, c.top_order = top, c.slave = slave;
      if (bottom == top) c.bottom_edge = 0.5, c.top_edge = 0.25;
      expect_passes(c, 1e-9);
    }
  Patch c;
  c.bottom_order = c.top_order = 2, c.bottom_edge = 0.5, c.top_edge = 0.25;
  for (double kappa : {1e4, 1e9}) c.kappa = kappa, expect_passes(c, 1e-9);
  c.kappa = 1e6, c.nu = 0.49, expect_passes(c, 1e-9);
  c.nu = 0.3, c.quadrature = "6", expect_passes(c, 1e-9);
  c.two_pass = true, expect_passes(c, 1e-9);
  c.top_side = 0.5, c.bottom_edge = 1.0 / 6, c.top_edge = 0.125, expect_passes(c, 1e-9);
  c.gradient = "exact", expect_passes(c, 1e-9);
}

// The published weights give back by edges and points what the taper takes from faces, which is right for the total only.
TEST(MortarPatch, TaperedWeightsMissIt) {
  Patch c;
  c.weights = "tapered";
  c.slave = "top", c.top_side = 0.5, c.bottom_edge = 1.0 / 6, c.top_edge = 0.125;
  const Result r = run(c);
  EXPECT_GT(r.szz, 1e-4);
  EXPECT_LT(r.szz, 0.2);
}
