#pragma once
// The stress in a tetrahedron of ten nodes: the linear field through its four points of integration, at the corners.
#include <array>

#include "base/types.h"

namespace mortise::run {

using Stress = Eigen::Matrix<double, 6, 1>;  // xx yy zz xy yz zx [Pa]
using CornerStress = std::array<Stress, 4>;

struct Isotropic {
  double E, nu;
  bool averaged = false;  // the change of volume is the element's mean
};

// Of nodes at rest, corners first, and their displacements [m]: S = lambda ln(J) I + 2 mu G with J and Green's strain G at the points, which turns with
// the body and is Hooke's law where strains are small.
CornerStress stress_of_quadratic(const std::array<Vec3, 10>& rest, const std::array<Vec3, 10>& moved, const Isotropic& of);

// Hooke's law at rest.
CornerStress linear_stress_of_quadratic(const std::array<Vec3, 10>& rest, const std::array<Vec3, 10>& moved, const Isotropic& of);

}  // namespace mortise::run
