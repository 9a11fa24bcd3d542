// Layers of one and two linear elements between what holds them: how much stiffer than in truth, and what bubbles on edges say of it
// (audit/bubble_error.h).
#include "audit/bubble_error.h"

#include <fmt/format.h>

#include "audit/field_errors.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A pad 3 mm thick between two plates, one of which shears and presses it.
std::string pad(double nu) {
  return fmt::format(R"(
mortise: 1
name: pad
time: {{mode: static, steps: 1}}
materials: {{rubber: {{youngs_modulus: 1 MPa, poisson_ratio: {}, density: 1100, volumetric: full}}}}
bodies:
  pad: {{type: soft, shape: {{box: {{size: [12 mm, 12 mm, 3 mm], edge_length: 3 mm}}}}, material: rubber}}
effects:
  elasticity: {{}}
  pin:
    - {{body: pad, where: {{side: z_min}}}}
    - {{body: pad, where: {{side: z_max}}, motion: {{time: [0, 1], translation: [[0, 0, 0], [0.1 mm, 0, -0.05 mm]]}}}}
)",
                     nu);
}

struct Loaded {
  double energy, missed;
};
Loaded load(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  Rig rig(scene, overrides);
  rig.step();
  const Captured said = rig.fields();
  std::vector<audit::BubbleError::Stress> stress;
  const std::vector<double>& all = said.cell.at("cauchy_stress");
  for (std::size_t t = 0; t < rig.input.bodies[0].tets.size(); ++t)
    stress.push_back(Eigen::Map<const audit::BubbleError::Stress>(all.data() + 6 * t));
  const std::vector<double>& moved = *said.of_points("displacement", 3);
  return {said.at("elasticity/energy"), audit::BubbleError(rig.input, rig.input.bodies[0]).of(stress, {}, moved)};
}

double stress_error(const std::string& scene, int steps) {
  Rig rig(scene);
  audit::FieldErrors errors(rig.input);
  for (int i = 1; i <= steps; ++i) rig.step(), errors.state(rig.fields(), static_cast<double>(i) / steps);
  return errors.result().stress;
}

}  // namespace

// Pins hold exactly: against a mesh four times as fine, which has some of the error itself.
TEST(BubbleError, IsWhatALayerIsTooStiffBy) {
  for (const double nu : {0.2, 0.3, 0.4})
    for (const char* edge : {"3 mm", "1.5 mm"}) {
      const Loaded coarse = load(pad(nu), {fmt::format("bodies.pad.shape.box.edge_length={}", edge)});
      const double fine = load(pad(nu), {"bodies.pad.shape.box.edge_length=0.6 mm"}).energy, error = 1 - fine / coarse.energy;
      EXPECT_GT(coarse.missed, 0.7 * error) << nu << ' ' << edge;
      EXPECT_LT(coarse.missed, 2.5 * error) << nu << ' ' << edge;
    }
}

// Nothing is missing of a stress that is the same everywhere, in a body that may become thicker and thinner.
TEST(BubbleError, IsNoneOfAnEvenStress) {
  std::string even = pad(0.3);
  even.replace(even.find("{side: z_min}"), 13, "{side: z_min}, axes: z"), even.replace(even.find("{side: z_max}"), 13, "{side: z_max}, axes: z");
  const std::string still = "\n    - {body: pad, where: {side: x_min}, axes: x}\n    - {body: pad, where: {side: y_min}, axes: y}\n";
  EXPECT_LT(load(even + still.substr(1)).missed, 1e-4);
}

// Two pads of one element each, one of which is tied to the other or pressed on it: no stress jumps there.
TEST(BubbleError, SeesLayersUnderTiesAndContacts) {
  const auto pads = [](const std::string& holds, double gap) {
    return fmt::format(R"(
mortise: 1
name: pads
time: {{mode: static, steps: 2}}
materials: {{rubber: {{youngs_modulus: 0.4 MPa, poisson_ratio: 0.4, density: 1100}}}}
bodies:
  a: {{type: soft, shape: {{box: {{size: [16 mm, 16 mm, 4 mm], edge_length: 4 mm}}}}, material: rubber, position: [0, 0, 2 mm]}}
  b: {{type: soft, shape: {{box: {{size: [16 mm, 16 mm, 4 mm], edge_length: 4 mm}}}}, material: rubber, position: [0, 0, {} mm]}}
effects:
  elasticity: {{}}
  pin:
    - {{body: a, where: {{side: z_min}}}}
    - {{body: b, where: {{side: z_max}}, motion: {{time: [0, 0.5, 1], translation: [[0, 0, 0], [0, 0, -0.8 mm], [0.6 mm, 0, -0.8 mm]]}}}}
  {}
)",
                       6 + gap, holds);
  };
  EXPECT_GT(stress_error(pads("mortar_tie: {body: b, where: {side: z_min}, to: a}", 0), 2), 0.1);
  EXPECT_GT(stress_error(pads("mortar_contact: {pairs: [{slave: a, master: b}]}\n  friction: {mu: 0.8, follows: mortar_contact}", 0.02), 2), 0.1);
}
