#pragma once
// Automatic stiffness. What decides the quality of the pressure is the stiffness of the barrier layer against that of the bodies,
//     k = kappa b''(g) h / E*,      1/E* = sum over the two bodies of (1 - nu^2)/E  (0 for stiff bodies and half-spaces),
// with h the edge of the slave faces that are pressed, each counted by its force: on a graded mesh the mean over the surface is several times theirs.
// Best near 4 (README). At pressure p the gap follows from
// p = kappa phi(t), so kappa = p / phi(t) with t the root of
//     -phi'(t) / phi(t) = k E* d_hat / (p h).
// The left side is smallest, 5.03, at t = 0.376: a layer of range d_hat cannot be softer than that at pressure p. Of the two roots the one above
// is taken, which keeps gaps wide open; in statics none below t = 0.7, where the left side is 7.6: at three times the mean pressure the gap is still
// d_hat/2 there, far from the guard's range, while from 0.376 on peaks of pressure are the guard's to carry. In motion a stiffer layer costs
// iterations and energy.
//
// The layer that the scene does not set (contact/layer.h) is stiffer than k = 4 at any pressure that matters: kappa = E* once and for all.
#include <span>

#include "effects/mortar_contact/frozen.h"

namespace mortise::effects::mortar {

struct Interface {
  Index slave = 0, master = 0;  // bodies; masters after the bodies are half-spaces
  double modulus = 0;           // E* [Pa]; 0 where nothing can deform
  double h = 0;                 // mean slave edge [m]
  bool fixed = false;           // kappa is E*
};
Interface interface_of(const model::Model& model, Index slave, Index master);
// Mean edge of every triangle of the surface at rest [m].
std::vector<double> edges(const model::Model& model);

// A chosen stiffness and the slave edge that it fits.
struct Fit {
  double kappa = 0, h = 0;  // [Pa], [m]
  bool operator==(const Fit&) const = default;
  // Of a guard pair [N]: kappa times the mean third of a slave triangle.
  double guard() const { return kappa * h * h / 7; }
};
// The share s of the way from a to b, both in the stiffness and in that of guard pairs.
Fit between(const Fit& a, const Fit& b, double s);

// kappa [Pa] before any pressure is known, for slave edges h.
double first_stiffness(const Interface& i, double h, double d_hat);
// kappa [Pa] for the interface at pressure p [Pa]. Where nothing can deform there is no mesh to be smooth for: the gap is kept open at least_t.
double wanted_stiffness(const Interface& i, double h, double d_hat, double p, double least_t);

// Samples of one interface, and what they are of.
struct Samples {
  Index interface;
  const std::vector<Pair>& pairs;
  std::span<const Sample> of_env;
  const std::vector<double>& edges;
};

// Force-weighted means over face samples: pressure sum w p^2 / sum w p [Pa], edge h [m], and k; and the energy of all samples [J]. 0 without contact.
struct Achieved {
  double pressure = 0, h = 0, k = 0, energy = 0;
};
Achieved achieved(const Interface& i, double kappa, const Samples& samples);
// The slave edge where bodies that do not press yet will: samples count by the depth at which they would lie were the nearest pressed in by a tenth
// of its edge. 0 without samples.
double nearest_edge(const Samples& samples);
// Is the stiffness good enough to stay: fixed, else k within a factor 2 of what is wanted, or, of stiff bodies, the gap neither nearly open nor half
// closed?
bool fits(const Interface& i, const Achieved& now, double kappa);

}  // namespace mortise::effects::mortar
