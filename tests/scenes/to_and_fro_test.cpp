// A ball that slides to and fro in a stiff trough, without friction: what the time step takes of its swing is told (audit/to_and_fro_loss.h).
#include <fmt/format.h>

#include <cmath>

#include "../geometry/mesh_helpers.h"
#include "audited.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// A part of a pipe of 60 mm inner radius that opens upwards, its lowest line through the origin.
std::string trough() {
  constexpr int n = 48;
  constexpr double inner = 0.06, outer = 0.07, half = 0.03;
  std::string out;
  for (const double y : {-half, half})
    for (const double r : {inner, outer})
      for (int i = 0; i <= n; ++i) {
        const double a = (i / double(n) - 0.5) * 2 * M_PI / 3;
        out += fmt::format("v {:.9g} {:.9g} {:.9g}\n", r * std::sin(a), y, inner - r * std::cos(a));
      }
  const auto at = [](int side, int layer, int i) { return (2 * side + layer) * (n + 1) + i + 1; };
  const auto quad = [&out](int a, int b, int c, int d) { out += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, c, a, c, d); };
  for (int i = 0; i < n; ++i) {
    quad(at(0, 0, i), at(0, 0, i + 1), at(1, 0, i + 1), at(1, 0, i));
    quad(at(0, 1, i), at(1, 1, i), at(1, 1, i + 1), at(0, 1, i + 1));
    quad(at(0, 0, i), at(0, 1, i), at(0, 1, i + 1), at(0, 0, i + 1));
    quad(at(1, 0, i), at(1, 0, i + 1), at(1, 1, i + 1), at(1, 1, i));
  }
  quad(at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0));
  quad(at(0, 0, n), at(0, 1, n), at(1, 1, n), at(1, 0, n));
  return out;
}

}  // namespace

TEST(ToAndFroLoss, IsHowMuchASwingIsTooShort) {
  const geometry::TempFolder folder;
  const std::string file = folder.write("trough.obj", trough());
  const auto lost = [&](const char* integrator, const char* step, int steps) {
    return turn(fmt::format(R"(
mortise: 1
name: trough
time: {{step: {}, steps: {}}}
bodies:
  ball: {{type: stiff, shape: {{sphere: {{radius: 10 mm, edge_length: 3 mm}}}}, mass: 30 g, position: [25 mm, 0, 16.75 mm]}}
  trough: {{type: stiff, shape: {{mesh: {{file: {}}}}}, mass: 1}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{}}
  pin: [{{body: trough, where: {{side: all}}}}]
  barrier_contact: {{}}
)",
                            step, steps, file, integrator),
                steps)
        .energy.own_loss;
  };
  // After four half swings in 0.9 s it should be back at 23.4 mm (facets take the rest of 25): 15.8 mm, 21.7 mm.
  EXPECT_NEAR(lost("backward_euler", "5 ms", 182), 0.25, 0.08);
  EXPECT_NEAR(lost("bdf2", "5 ms", 182), 0.07, 0.03);
}
