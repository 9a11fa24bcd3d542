// A stiff box pressed edge first and corner first into a soft pad: the true gap of densely sampled
// edges stays positive and every step converges. Face samples alone let a corner through without any force.
#include <cstdio>

#include "place.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kHat = 2e-3;

struct Sharp {
  std::string name;
  Mat3 R;
  std::string rotation;  // for the scene
  std::string options;
  std::string stiffness = "10 MPa";
};

Sharp turned(const std::string& name, double degrees, const Vec3& axis, const std::string& options = "", const std::string& stiffness = "10 MPa") {
  char text[160];
  std::snprintf(text, sizeof text, "{axis: [%.17g, %.17g, %.17g], angle: %.17g deg}", axis[0], axis[1], axis[2], degrees);
  return {name, Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()).toRotationMatrix(), text, options, stiffness};
}

// Smallest height of points on the box's surface edges over the pad's upper surface.
double true_gap(Rig& rig) {
  const std::vector<double> y = rig.engine->points();
  const auto at = [&](std::size_t i) { return Vec3(y[3 * i], y[3 * i + 1], y[3 * i + 2]); };
  const std::size_t first = rig.input.bodies[0].nodes.size();
  double least = INFINITY;
  for (const Triangle& t : rig.input.bodies[1].triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = at(first + t.v[k]), b = at(first + t.v[(k + 1) % 3]);
      for (int i = 0; i <= 100; ++i) {
        const Vec3 p = a + i / 100.0 * (b - a);
        if (p.z() > 0.3) continue;
        for (const Triangle& s : rig.input.bodies[0].triangles) {
          const Vec3 c[3] = {at(s.v[0]), at(s.v[1]), at(s.v[2])};
          const Vec3 n = (c[1] - c[0]).cross(c[2] - c[0]);
          if (!(n.z() > 0.5 * n.norm())) continue;
          double M[3];
          M[1] = (p - c[0]).cross(c[2] - c[0]).z() / n.z(), M[2] = (c[1] - c[0]).cross(p - c[0]).z() / n.z(), M[0] = 1 - M[1] - M[2];
          if (M[0] < 0 || M[1] < 0 || M[2] < 0) continue;
          least = std::min(least, p.z() - (M[0] * c[0] + M[1] * c[1] + M[2] * c[2]).z());
        }
      }
    }
  return least;
}

struct Result {
  double gap = INFINITY, force = 0;
  long newton = 0, most = 0;
};

// 2 d_hat of travel after first coming into range, in `steps` static steps.
Result press(const Sharp& c, int steps) {
  double low = INFINITY;
  for (int i = 0; i < 8; ++i) low = std::min(low, (c.R * Vec3(i & 1 ? 0.275 : -0.275, i & 2 ? 0.3 : -0.3, i & 4 ? 0.25 : -0.25)).z());
  char text[2000];
  std::snprintf(text, sizeof text, R"(
mortise: 1
name: sharp
time: {mode: static, steps: %d}
materials:
  rubber: {model: linear, youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [1, 1, 0.5], edge_length: 0.125}}, material: rubber, position: [0, 0, -0.25]}
  box: {type: stiff, shape: {box: {size: [0.55, 0.6, 0.5], edge_length: 0.3}}, material: rubber, position: [0.013, 0.021, %.17g], rotation: %s}
effects:
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}, axes: xyz}
    - {body: box, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, %.17g]]}}
  mortar_contact: {pairs: [{slave: pad, master: box}], d_hat: %.17g, stiffness: %s%s}
solver: {relative_tolerance: 1e-8, force_tolerance: 1e-9 N, iterations: 60}
)",
                steps, 1.01 * kHat - low, c.rotation.c_str(), -3 * kHat, kHat, c.stiffness.c_str(), c.options.c_str());
  Rig rig(text);
  Result r;
  for (int n = 0; n < steps; ++n) {
    const solver::StepReport report = rig.step();
    r.newton += report.newton;
    r.most = std::max<long>(r.most, report.newton);
    r.gap = std::min(r.gap, true_gap(rig));
  }
  r.force = rig.fields().at("mortar_contact/force_box_z");
  std::printf("  %s: least true gap %.3f d_hat, force %.4g N, %ld iterations in all, %ld at most\n", c.name.c_str(), r.gap / kHat, r.force, r.newton,
              r.most);
  return r;
}

}  // namespace

TEST(MortarSharp, EdgesAndCornersDoNotPenetrate) {
  for (const Sharp& c : {turned("edge 45 deg", 45, {1, 0, 0}), turned("edge 10 deg, soft", 10, {1, 0, 0}, "", "10 kPa"),
                         turned("corner, soft, no guard", 43, {1, 0.8, 0.1}, ", guard: 0", "10 kPa"),
                         turned("corner, soft, tapered", 43, {1, 0.8, 0.1}, ", weights: tapered", "10 kPa")}) {
    const Result r = press(c, 10);
    EXPECT_GT(r.gap, 0) << c.name;
    EXPECT_GT(r.force, 0) << c.name;
  }
}

// H07: a tetrahedron falls through a slot with 0.5 um to spare and spreads on the floor, so that its tips slide along the walls. What stands
// beside a tip must not cut steps short.
TEST(MortarSharp, TipsSlideAlongWalls) {
  Rig rig(R"(
mortise: 1
name: slot
time: {step: 25 ms, steps: 18}
materials:
  gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
  rock: {density: 1000}
bodies:
  tet: {type: soft, shape: {mesh: {file: )" +
          test_place::kSourceFolder + R"(/scenes/hard/meshes/tet_slot.msh}}, material: gel}
  left: {type: stiff, shape: {box: {size: [1, 2, 1], edge_length: 2}}, material: rock, position: [-1.0000005, 0, -0.2]}
  right: {type: stiff, shape: {box: {size: [1, 2, 1], edge_length: 2}}, material: rock, position: [1.0000005, 0, -0.2]}
  floor: {type: half_space, point: [0, 0, -0.7]}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  pin:
    - {body: left, where: {side: all}}
    - {body: right, where: {side: all}}
  mortar_contact: {pairs: [{slave: tet, master: left}, {slave: tet, master: right}, {slave: tet, master: floor}], d_hat: 1e-6 m}
)");
  for (int n = 0; n < 18; ++n) EXPECT_LE(rig.step().newton, 30) << n;
}

// H63: a cone is pressed into a pad next to a node. Newton's iterations run in a circle, as the tip passes from one slave triangle to the next; those
// on the forces themselves must start from the nearest state of it.
TEST(MortarSharp, ConeOnPad) {
  Rig rig(R"(
mortise: 1
name: cone
time: {mode: static, steps: 10}
materials:
  gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
  rock: {density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [0.2, 0.2, 0.08], edge_length: 0.02}}, material: gel, position: [0, 0, -0.0405]}
  cone: {type: stiff, shape: {mesh: {file: )" +
          test_place::kSourceFolder + R"(/scenes/hard/meshes/cone.msh, scale: 0.2}}, material: rock, position: [0.003, 0.002, 0]}
effects:
  elasticity: {}
  pin:
    - {body: pad, where: {side: z_min}}
    - {body: cone, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -0.03]]}}
  mortar_contact: {pairs: [{slave: pad, master: cone}], d_hat: 1 mm}
)");
  for (int n = 0; n < 4; ++n) EXPECT_LE(rig.step().newton, 60) << n;
}
