#pragma once
// What a mesh leaves out. Stresses jump between elements, and their averages at nodes are closer to the truth (Zienkiewicz, Zhu, Int. J. Numer. Meth.
// Engng 24, 1987). Elements hold too much energy by that of the jumps,
//
//   E_missed = 1/2 sum over elements of int B(D s, D s) dV,    D s = s* - s,
//   B(u, z) = 2 mu e_u : e_z + lambda theta_u theta_z + p_u theta_z + theta_u p_z - p_u p_z / l,
//
// with the state s = (e, theta, p) of a point: strain, change of volume, and what acts of means of it over clusters or elements where the body says
// so, p = l <theta>, l what of lambda does (README.md; B is that of the mixed form, of which averages are one: elements may be too soft as well). A
// star is the field of better values at nodes, interpolated as displacements are: averages over the elements around, weighted by volume; with
// quadratic elements polynomials of second order through their points of integration there (superconvergent patch recovery: the same, 33, 1992), as
// averages would be off by as much as stresses are. States are found from Cauchy's stress, so that what turns has the forces that turn with it;
// strains are small where stresses are linear in them. D is linear in s, so that E_missed has forces that turn the solution u of a mesh towards the
// truth to first order: of any number Q, with z what it hangs on (solver/adjoint.h), they make
//
//   Q(exact) - Q  ~  - z . grad E_missed  =  - sum over elements of int B(D s(u), D s(z)) dV
//
// (for goals: Prudhomme, Oden, Comput. Methods Appl. Mech. Engrg. 176, 1999). Averages at nodes that are held are of one side: of linear elements
// without means all is multiplied by the nodes of the body over its free ones (audit/stress_error.h).
#include "effects/elasticity/tets.h"

namespace mortise::effects::elasticity {

// Of a point of integration: strain xx yy zz xy yz zx, theta, p [Pa].
using State = Eigen::Matrix<double, 8, 1>;

// Weighted sums of states.
struct SumsView {
  View<const Index> first, of;
  View<const double> weight;
  MORTISE_HD State sum(Index i, View<const State> states) const {
    State out = State::Zero();
    for (Index k = first[i]; k < first[i + 1]; ++k) out += weight[k] * states[of[k]];
    return out;
  }
};

class Missed {
 public:
  explicit Missed(const model::Model& model);
  // Adds -share times the gradient of E_missed [N], or of all of it that is not 2 mu e : e, at positions q where clusters have the pressures of
  // `tets`, to the stencils of elements.
  void mend(const Tets& tets, Positions q, double share, bool sheared = true);
  void add_to(const linalg::StencilView& out) const;
  // -share E_missed there [J].
  double energy() const { return energy_; }

 private:
  const model::Model& model_;
  // Nodes of elements one after another, and of every block its places among them.
  device::Buffer<Index> first_node_, first_place_, place_;
  // s* of a block, as a sum over points of integration; and the blocks whose sums have a point.
  struct Sums {
    device::Buffer<Index> first, of;
    device::Buffer<double> weight;
    SumsView view() const { return {first.view(), of.view(), weight.view()}; }
  };
  Sums star_, back_;
  device::Buffer<double> one_sided_;  // of elements
  device::Buffer<Vec3> forces_;       // of nodes of elements
  double energy_ = 0;
};

}  // namespace mortise::effects::elasticity
