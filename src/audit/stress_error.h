#pragma once
// How much of the elastic energy the mesh may have missed: stresses of linear tetrahedra jump from element to element, and their averages at
// nodes are closer to the truth (Zienkiewicz, Zhu, Int. J. Numer. Meth. Engng 24, 1987). With s_h the stress of an element, s* the linear
// field of averages over volume at its nodes, and w(s) = ((1 + nu) s:s - nu tr(s)^2) / (2 E) the energy density of a stress,
//
//   missed = sum over elements of int w(s* - s_h) dV,   estimate = missed / (missed + sum over elements of int w(s*) dV),
//
// which is an estimate of the relative error of the energy, so of a force at imposed travel or of a travel at imposed force. Elements that lock
// (linear ones near nu = 1/2) show in it, as their pressures alternate. Stresses of quadratic elements are linear within an element: s_h is
// the field through its four points of integration, S = lambda ln(J) I + 2 mu G with J and Green's strain G there (which turns with the body, and is
// Hooke's law where strains are small); where volumes are averaged over elements, with the mean of J.
// Averages at nodes that are held are of one side, and say little: of linear elements without averaged volumes as much again is missed there as at
// free nodes (blocks of two to four cells between clamps had half to a third of their true error), so that a body's part is multiplied by all of its
// nodes over the free ones.
// Quadratic bodies of one element across have no neighbour to tell what a stress within an element is worth (cubes that were sheared and turned were
// 7 to 24 % too stiff with estimates below 0.03): a share of the energy of what varies within elements counts as missed, and held nodes as above.
// Nor has the surface where something presses a part of a face: of quadratic elements that are pressed, and of those beside them, jumps count
// kPressed times (balls pressed them 3 to 16 % too hard where estimates were half of that). Elements that have no free node deform as pins and bonds
// say, whatever they are made of: nothing tells how wrong that is, and all of their energy counts as missed (a pad of rubber between two plates, one
// element thick, is as stiff as if it could not bulge). Of linear bodies with few nodes inside bubbles on their edges tell that (bubble_error.h): the
// larger of what they and what jumps miss counts.
//
// Uniform stress hides what varies (a column that carries a load and bends a little). `bending` is the error of the motion of bodies of which slices
// across their axes go on average, as seen from where they are held, half or more of the farthest way by no stretch alike everywhere, and as much
// less as that is less (what bulges alike to all sides moves no slice): with the energy U of s* without its mean m over the body in the place of all
// of it, where it is less than kHidden of that. What presses such a body together works on its bending, G = sum V m : 1/2 H^T H with H the slopes of
// its displacement as seen from where it is held, without that stretch; near the load at which it buckles that leaves little stiffness, U + G, and an
// error of U weighs U / (U + G) times, kAmplified at most.
#include <array>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "audit/bubble_error.h"
#include "geometry/rigid_motion.h"
#include "model/input.h"

namespace mortise::audit {

class StressError {
 public:
  explicit StressError(const model::ModelInput& input);

  using Stress = Eigen::Matrix<double, 6, 1>;  // xx yy zz xy yz zx [Pa]
  // At the corners of every tetrahedron of every soft body, in axes that turn with its material: so that two states can be told from each other.
  using Stresses = std::vector<std::vector<std::array<Stress, 4>>>;
  // cauchy_stress of all output cells, six components each [Pa], and displacement of all points [m].
  Stresses stresses(std::span<const double> stress, std::span<const double> displacement) const;
  static Stresses change(Stresses after, const Stresses& before);

  struct Estimate {
    std::map<std::size_t, double> errors;   // by group, of those that have energy at all
    std::map<std::size_t, double> bending;  // of those that have such bodies
    double energy = 0;                      // of the group that has most [J]
    double error() const;                   // the largest; NaN where nothing can be estimated
  };
  // group: by body that has points. Of all points: forces of contact [N], empty without, and displacements [m].
  Estimate of(const Stresses& stresses, const std::vector<std::size_t>& group, std::span<const double> contact_force = {},
              std::span<const double> displacement = {}) const;

 private:
  struct Body {
    std::size_t number;  // among those that have points
    std::size_t first_cell, first_point;
    std::vector<Tet> tets;
    std::vector<geometry::Midsides> midsides;  // of quadratic ones
    std::vector<Vec3> rest;
    std::vector<double> volume;      // per tetrahedron [m^3]
    std::vector<bool> held;          // those that have no free node
    std::vector<std::size_t> fixed;  // nodes that are held
    double E, nu;
    bool averaged;         // volumes, over elements
    bool turns;            // its stresses with it: not by the law of small rotations
    double one_sided = 1;  // nodes over free nodes; 1 where that makes no difference
    bool one_across = false;
    std::optional<BubbleError> bubbles = {};
  };
  using Corners = std::array<Stress, 4>;
  static Corners of_quadratic(const Body& b, std::size_t tet, std::span<const double> displacement);
  static Mat3 turn(const Body& b, std::size_t tet, std::span<const double> displacement);
  struct Energy {
    double missed = 0, all = 0;
    double varying = 0, left = 1;  // of it what counts, and (U + G) / U
    double bent = 0;               // how much of the way of the body its error counts for
  };
  static std::vector<bool> near_pressed(const Body& b, std::span<const double> contact_force);
  static Energy energy_of(const Body& b, const std::vector<Corners>& here, std::span<const double> contact_force,
                          std::span<const double> displacement);
  // The rigid motion of what holds it, or its own where that does not fix one.
  static geometry::Motion base(const Body& b, std::span<const double> displacement);
  // Less the identity: of the nearest that is alike everywhere, turned so that what is held turns least (a pad that is sheared is no column that
  // leans).
  static Mat3 stretch(const Body& b, std::span<const double> displacement);
  // How much of its way, as seen from there, means of its slices have beside that stretch, over kNotAffine of it: 1 at most.
  static double bent(const Body& b, const geometry::Motion& base, const Mat3& stretch, std::span<const double> displacement);
  // G [J].
  static double worked(const Body& b, const geometry::Motion& base, const Mat3& stretch, const Stress& uniform, std::span<const double> displacement);
  std::vector<Body> bodies_;
};

}  // namespace mortise::audit
