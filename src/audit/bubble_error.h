#pragma once
// What linear tetrahedra miss where stresses hardly jump, since no node lies between the surfaces that hold a body: a pad of one or two elements
// between two plates is as stiff as if it could not bulge, and each of its elements has the same stress. A quadratic bubble phi_e = 4 l_i l_j on
// every edge e = ij that is free to move (l: barycentric coordinates, g: their gradients), beside a mesh that stays as it is, takes away the energy
//
//     missed = max over x of  r . x - 1/2 x . K x = 1/2 r . K^-1 r,     r_e = sum over its tetrahedra of V (b / 5 - S (g_i + g_j)),
//
// b: the force on their volume (weight, inertia), that which balances the stresses at nodes that nothing else acts on, V/4 sum b = sum V S g_i, its
// mean over those of a tetrahedron; S: their stress; K: stiffness of the bubbles (an error estimate by hierarchical bases: Bank, Smith, SIAM J.
// Numer. Anal. 30, 1993). Edges on which something else acts are held: those within what a pin, a bond or a mortar tie holds, and of faces that
// contact presses. Poisson's ratio is kCompressible at most: bubbles by themselves cannot keep a volume. What holds may give way as well, and its
// edges are held here: all that is missed is more, by kHeldMisses times the share of the surface that is held.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

// The surface of one linear soft body, its edges, and what holds those for good.
class BubbleError {
 public:
  // Of all bodies: effects hold them together.
  BubbleError(const model::ModelInput& input, const model::BodyInput& body);

  // No more than half of its nodes are inside: only there this is needed.
  static bool counts_for(const model::BodyInput& body);

  using Stress = Eigen::Matrix<double, 6, 1>;  // xx yy zz xy yz zx [Pa], in axes that turn with the material
  // Share of the energy of these stresses, one per tetrahedron, that is missed. Of the body's nodes: forces of contact [N], empty without, and
  // displacements [m].
  double of(const std::vector<Stress>& stress, std::span<const double> contact_force, std::span<const double> displacement) const;

 private:
  using Axes = unsigned;  // bit per axis
  struct Element {
    Index node[4], edge[6];
    Vec3 g[4];
    double volume;
  };
  static Vec3 slope_of(const Element& e, int k, const double (&l)[4]);
  void hold(const std::vector<Index>& nodes, Axes axes);  // edges between them
  void hold_under_tie(const model::BodyInput& slave, const Params& tie);
  std::vector<Axes> held(std::span<const double> contact_force, std::span<const double> displacement, double& share) const;
  std::vector<Vec3> times(const std::vector<Vec3>& x) const;  // K x
  // b of every node; 0 where something else acts [N/m^3].
  std::vector<Vec3> body_force(const std::vector<Mat3>& S, std::span<const double> contact_force) const;

  std::string name_;
  std::vector<Vec3> rest_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<Index, 2>> edges_;
  std::vector<std::array<Index, 3>> sides_;  // edges of triangles_
  std::vector<Element> elements_;
  std::vector<Axes> held_;   // by edge
  std::vector<bool> acted_;  // by node: something holds or loads it
  double E_, nu_, lambda_, mu_;
};

}  // namespace mortise::audit
