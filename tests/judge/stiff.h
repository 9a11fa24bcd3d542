#pragma once
// Stiff bodies whose mass is spread as the scene states it (`mass`, `inertia`), not evenly over their shape.
#include <array>
#include <vector>

#include "judge/vector.h"

namespace YAML {
class Node;
}

namespace judge {

struct Body;

// In the place where the body is at rest: mass [kg], centre of mass [m], int rho X X^T with X from there [kg m^2] by rows.
struct Spread {
  double mass = 0;
  Vector centre{};
  std::array<double, 9> second{};
};

// `block`: of the body in the resolved scene.
Spread stated_spread(const YAML::Node& block, const Body& body, const std::vector<Vector>& rest);

// A field that is linear in space, u = u_c + G (X - centre), known at the points of a body: u_c, and with `square` int rho u.u.
Vector at_centre(const Spread& spread, const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& field, double* square = nullptr);

// A direction of a body at rest, where its points are at x.
Vector turned(const Body& body, const std::vector<Vector>& rest, const std::vector<Vector>& x, const Vector& direction);

}  // namespace judge
