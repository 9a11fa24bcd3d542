#pragma once
// Automatic stiffness. What decides the quality of the pressure is the stiffness of the barrier layer against that of the bodies,
//     k = kappa b''(g) h / E*,      1/E* = sum over the two bodies of (1 - nu^2)/E  (0 for stiff bodies and half-spaces),
// with h the mean edge of the slave surface; best near 4 (README). At pressure p the gap follows from
// p = kappa phi(t), so kappa = p / phi(t) with t the root of
//     -phi'(t) / phi(t) = k E* d_hat / (p h).
// The left side is smallest, 5.03, at t = 0.376: a layer of range d_hat cannot be softer than that at pressure p. Of the two roots the one above
// is taken, which keeps gaps wide open; in statics none below t = 0.7, where the left side is 7.6: at three times the mean pressure the gap is still
// d_hat/2 there, far from the guard's range, while from 0.376 on peaks of pressure are the guard's to carry. In motion a stiffer layer costs
// iterations and energy.
//
// Between bodies that cannot deform the layer is the only spring, on which they rock: a tall box that slides, or stands on a slope, leans on one edge
// by what that yields. There kappa is contact::tuning::kRigid, as with barrier_contact, until the gap is half closed.
//
// The layer that the scene does not set (contact/layer.h) is stiffer than k = 4 at any pressure that matters: kappa = E* once and for all.
#include <span>
#include <vector>

#include "effects/mortar_contact/frozen.h"

namespace mortise::effects::mortar {

struct Interface {
  Index slave = 0, master = 0;  // bodies; masters after the bodies are half-spaces
  Index env = 0;
  double d_hat = 0;    // [m]
  double modulus = 0;  // E* [Pa]; 0 where nothing can deform
  double h = 0;        // mean slave edge [m]
  bool fixed = false;  // kappa is E*
};
// d_hat [m]; set: by the scene.
Interface interface_of(const model::Model& model, Index slave, Index master, double d_hat, bool set);

// kappa [Pa] before any pressure is known.
double first_stiffness(const Interface& i);
// kappa [Pa] for the interface at pressure p [Pa]. Where nothing can deform there is no mesh to be smooth for: the gap is kept open at least_t.
double wanted_stiffness(const Interface& i, double p, double least_t);

// The samples of a state, on the host.
struct Taken {
  std::vector<Pair> pairs;
  std::vector<Sample> samples;
  std::vector<Index> first;  // of every environment
  explicit Taken(const FrozenSamples& f) : pairs(f.pairs.download()), samples(f.samples.download()), first(f.env_samples) {}
  std::span<const Sample> of_env(Index env) const { return std::span(samples).subspan(first[env], first[env + 1] - first[env]); }
};

// Force-weighted means over the face samples of interface `number`: pressure sum w p^2 / sum w p [Pa] and k; and the energy of all its samples [J].
// 0 without contact.
struct Achieved {
  double pressure = 0, k = 0, energy = 0;
};
Achieved achieved(const Interface& i, Index number, double kappa, const Taken& at);
// Is the stiffness good enough to stay: fixed, else k within a factor 2 of what is wanted, or, of stiff bodies, the gap not half closed?
bool fits(const Interface& i, const Achieved& now, double kappa);

}  // namespace mortise::effects::mortar
