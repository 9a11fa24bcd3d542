#pragma once
// What the mesh has left out of a number Q, from stresses that jump between linear tetrahedra (audit/stress_error.h): with z, what Q hangs on
// (solver/adjoint.h), as a displacement,
//
//   Q(exact) - Q  ~  - sum over elements of int 2 mu De(u) : De(z) + Dp(u) Dtheta(z) + Dtheta(u) Dp(z) - Dp(u) Dp(z) / lambda dV,   D = * - 1
//
// where e is the strain of an element, theta its change of volume and p = lambda <theta> what acts of it, averaged over clusters where the body says
// so (effects/elasticity/README.md), and a star is the linear field of averages at nodes (Zienkiewicz, Zhu 1987; for goals: Prudhomme, Oden, Comput.
// Methods Appl. Mech. Engrg. 176, 1999). Without clusters p = lambda theta, and the integrand is Ds(u) : C^-1 : Ds(z) of the stresses s. With them it
// is that of the mixed form, of which averages are one: elements may then be too soft as well as too stiff. Strains are taken as small, those of z as
// at rest.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::study {

class GoalError {
 public:
  // Of a solution. stress: cauchy_stress of all output cells, six components each (xx yy zz xy yz zx) [Pa]; points: three per point [m].
  GoalError(const model::ModelInput& input, std::span<const double> stress, std::span<const double> points);
  // Why the mesh's part is not to be had of it; empty where it is.
  const std::string& why_not() const { return why_not_; }
  double of(std::span<const double> z) const;  // three per point

 private:
  using Field = Eigen::Matrix<double, 8, 1>;  // of an element: e (xx yy zz xy yz zx), theta, p [Pa]
  using Corners = std::array<Field, 4>;
  struct Body {
    std::size_t first_cell, first_point, nodes;
    std::vector<Tet> tets;
    std::vector<double> volume;   // [m^3]
    std::vector<Mat3> inverse;    // of the edges at rest [1/m]
    double mu, lambda;            // [Pa]
    bool linear;                  // its law: theta = tr e, not J - 1
    std::vector<Index> cluster;   // of every tetrahedron; empty where volumes are not averaged
    double one_sided = 1;         // nodes over free nodes (audit/stress_error.h)
    std::vector<Corners> jump{};  // of the solution
  };
  static std::vector<Mat3> gradients(const Body& b, std::span<const double> of);
  static std::vector<Field> of_solution(const Body& b, std::span<const double> stress, std::span<const double> points);
  static std::vector<Field> of_adjoint(const Body& b, std::span<const double> z);
  static std::vector<Corners> jumps(const Body& b, const std::vector<Field>& of);
  static double product(const Body& b, const Field& u, const Field& z);
  std::vector<Body> bodies_;
  std::string why_not_;
};

}  // namespace mortise::study
