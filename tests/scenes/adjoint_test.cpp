// What a number of a solved state hangs on: its adjoint, against what is known and against better runs.
#include <cmath>

#include "patch.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr double kStiffness = 1e5 * 4e-4 / 0.01, kTravel = 0.5e-3;  // E A / L [N/m]; beyond the first touch [m]

solver::Adjoint adjoint(Rig& rig, const solver::Functional& of) {
  solver::Adjoint out;
  Rig::check(rig.engine->adjoint(of, out));
  return out;
}

constexpr int kBlockBody = 0, kPlateBody = 1, kZ = 2;

void shows_its_gap(const std::string& contact) {
  SCOPED_TRACE(contact);
  Rig rig(patch(contact));
  rig.step();
  const Captured f = rig.fields();
  const double force = -f.at("supports/plate_z"), too_much = force - kStiffness * kTravel;
  ASSERT_GT(too_much, 0.02 * force);
  const solver::Adjoint plate = adjoint(rig, {{}, kPlateBody, kZ}), block = adjoint(rig, {{}, kBlockBody, kZ});
  EXPECT_NEAR(plate.layer, too_much, 0.1 * too_much);
  EXPECT_NEAR(block.layer, -too_much, 0.1 * too_much) << "below, the same force the other way";
  EXPECT_NEAR(plate.residual, 0, 1e-6 * force);
  // The plate's z is the way that all would go with it, one metre per metre, to nothing at the block's lower side: but for the layer linear in z.
  const std::vector<double> points = rig.engine->points();
  for (std::size_t i = 0; i < points.size(); i += 3) {
    const bool of_plate = points[i + 2] > 0.0099;
    const double expected = of_plate ? 1 : points[i + 2] / 0.0095;
    if (of_plate || contact.starts_with("mortar")) {
      EXPECT_NEAR(plate.points[i + 2], expected, of_plate ? 1e-12 : 0.06);
    }
  }
}

}  // namespace

TEST(Adjoint, OfAForceTellsWhatTheGapAddsToIt) {
  shows_its_gap("mortar_contact: {d_hat: 0.1 mm, stiffness: 0.1 MPa, pairs: [{slave: block, master: plate}]}");
  shows_its_gap("mortar_contact: {d_hat: 0.02 mm, stiffness: 0.1 MPa, pairs: [{slave: block, master: plate}]}");
  shows_its_gap("barrier_contact: {d_hat: 0.1 mm, stiffness: 1 MPa}");
}

// A bar that hangs on a pinned body by a bond: what holds that body is the force of the bar's own support, and hangs on the same things.
TEST(Adjoint, GoesThroughBonds) {
  constexpr const char* kHeld = R"(
mortise: 1
name: held
time: {mode: static, steps: 1}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  bar: {type: soft, shape: {box: {size: [40 mm, 10 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [20 mm, 0, 0]}
  grip: {type: stiff, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 10 mm}}, mass: 1, position: [45 mm, 0, 0]}
effects:
  elasticity: {}
  bond: [{body: bar, to: grip, where: {side: x_max}}]
  pin:
    - {body: bar, where: {side: x_min}}
    - {body: grip, where: {side: all}, motion: {time: [0, 1], translation: [[0, 0, 0], [1 mm, 0, 2 mm]]}}
)";
  Rig rig(kHeld, {"solver.relative_tolerance=1e-11"});
  rig.step();
  constexpr int kBar = 0, kGrip = 1;
  const solver::Adjoint bar = adjoint(rig, {{}, kBar, kZ}), grip = adjoint(rig, {{}, kGrip, kZ});
  const std::vector<double> points = rig.engine->points();
  double most = 0;
  for (std::size_t i = 0; i < points.size(); i += 3) {
    // Moved with both of its ends it does not strain: the two are one metre per metre together.
    EXPECT_NEAR(bar.points[i + 2] + grip.points[i + 2], 1, 1e-6);
    if (points[i] > 0.0409) {
      EXPECT_NEAR(grip.points[i + 2], 1, 1e-12) << "goes with the grip";
    }
    most = std::max(most, std::abs(grip.points[i]));
  }
  EXPECT_GT(most, 1e-3) << "it bends";
  EXPECT_NEAR(grip.residual, 0, 1e-9);
}

// A block that is bent by gravity far enough for Newton's method to take iterations: stopped too early, the adjoint tells what is missing.
TEST(Adjoint, TellsWhatNewtonLeft) {
  constexpr const char* kBent = R"(
mortise: 1
name: bent
time: {mode: static, steps: 1}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  beam: {type: soft, shape: {box: {size: [40 mm, 10 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [20 mm, 0, 0]}
effects:
  elasticity: {}
  gravity: {acceleration: [0, 0, -9.81]}
  pin: [{body: beam, where: {side: x_min}}]
)";
  const auto run = [&](const std::string& tolerance) {
    auto rig = std::make_unique<Rig>(kBent, std::vector<std::string>{"solver.relative_tolerance=" + tolerance});
    rig->step();
    return rig;
  };
  const auto exact = run("1e-11"), rough = run("0.01");
  const std::vector<double> best = exact->engine->points(), points = rough->engine->points();
  std::size_t tip = 0;
  for (std::size_t i = 0; i < points.size(); i += 3)
    if (points[i] > points[tip]) tip = i;
  solver::Functional sag;
  sag.points.assign(points.size(), 0.0);
  sag.points[tip + 2] = 1;
  const double missing = best[tip + 2] - points[tip + 2];
  ASSERT_GT(std::abs(missing), 1e-11);
  const solver::Adjoint found = adjoint(*rough, sag);
  EXPECT_TRUE(found.exact);
  EXPECT_NEAR(found.residual, missing, 0.1 * std::abs(missing));
  EXPECT_EQ(found.layer, 0) << "nothing touches";
}
