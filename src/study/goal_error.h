#pragma once
// What the mesh has left out of a number Q, from stresses that jump between linear tetrahedra (run/stress_error.h): with z, what Q hangs on
// (solver/adjoint.h), as a displacement,
//
//   Q(exact) - Q  ~  - sum over elements of int (s*(u) - s(u)) : C^-1 : (s*(z) - s(z)) dV
//
// where s is the stress of an element and s* the linear field of its averages at nodes (Zienkiewicz, Zhu 1987; for goals: Prudhomme, Oden, Comput.
// Methods Appl. Mech. Engrg. 176, 1999). Stresses of z are linear ones at rest: strains are taken as small.
#include <span>
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::study {

class GoalError {
 public:
  explicit GoalError(const model::ModelInput& input);
  // Why the mesh's part is not to be had of this scene; empty where it is.
  const std::string& why_not() const { return why_not_; }
  // stress: cauchy_stress of all output cells, six components each (xx yy zz xy yz zx) [Pa]; z: three per point.
  double of(std::span<const double> stress, std::span<const double> z) const;

 private:
  struct Body {
    std::size_t first_cell, first_point, nodes;
    std::vector<Tet> tets;
    std::vector<double> volume;  // [m^3]
    std::vector<Mat3> inverse;   // of the edges at rest [1/m]
    double E, nu;
    double one_sided = 1;  // nodes over free nodes (run/stress_error.h)
  };
  std::vector<Body> bodies_;
  std::string why_not_;
};

}  // namespace mortise::study
