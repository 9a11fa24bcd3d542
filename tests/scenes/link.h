#pragma once
// A link on a hinge, and how it moves.
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

namespace mortise::testing {

// A link of 100 x 20 x 20 mm and 40 g on a hinge at its end, from the horizontal; weight turns it by kWeight cos(angle) about y.
inline constexpr double kInertia = 0.04 * (0.1 * 0.1 / 3 + 0.02 * 0.02 / 12), kWeight = 0.04 * 9.81 * 0.05;

inline std::string link(const std::string& joint, const std::string& drive, double dt_ms, const std::string& integrator = "backward_euler",
                        int steps = 1000) {
  return fmt::format(R"(
mortise: 1
name: link
time: {{step: {} ms, steps: {}}}
materials: {{steel: {{density: 1000}}}}
bodies:
  arm: {{type: stiff, shape: {{box: {{size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}}}, material: steel, position: [50 mm, 0, 0]}}
effects:
  inertia: {{integrator: {}}}
  gravity: {{}}
  affine_body: {{stiffness: 1 GPa}}
  joint: [{{name: hip, type: revolute, body: arm, at: [0, 0, 0], axis: [0, 1, 0]{}}}]
{})",
                     dt_ms, steps, integrator, joint, drive.empty() ? "" : "  drive: [{joint: hip, " + drive + "}]\n");
}

// Angle and rate at t of I theta'' = torque(t, theta, theta'), from rest, by the classical Runge-Kutta method.
template <class F>
std::pair<double, double> motion(F torque, double t, int n = 20000) {
  double x = 0, v = 0;
  const double h = t / n;
  const auto a = [&](double at, double y, double w) { return torque(at, y, w) / kInertia; };
  for (int i = 0; i < n; ++i) {
    const double s = i * h;
    const double k1 = v, l1 = a(s, x, v), k2 = v + h / 2 * l1, l2 = a(s + h / 2, x + h / 2 * k1, k2), k3 = v + h / 2 * l2,
                 l3 = a(s + h / 2, x + h / 2 * k2, k3), k4 = v + h * l3, l4 = a(s + h, x + h * k3, k4);
    x += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), v += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
  return {x, v};
}

}  // namespace mortise::testing
