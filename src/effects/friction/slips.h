#pragma once
// The samples of a contact effect as friction has them: how far each slips, and what of it is frozen while Newton iterates.
#include "effects/effect.h"
#include "effects/friction/law.h"
#include "geometry/body_pairs.h"
#include "linalg/stencils.h"
#include "model/contact_view.h"
#include "model/model.h"

namespace mortise::effects::friction {

using model::ContactSample;

// What is frozen of a sample during Newton.
struct FrozenContact {
  Vec3 normal;
  double mu, load;  // load: mu times the normal force [N]
  Vec3 anchor;      // what its slip begins with [m]
};

// What points hold at the start of the step (anchors.h).
struct AnchorsView {
  View<const Vec3> deflection;  // of every point, in creep distances
  View<const Index> body;       // of every point
  View<const double> cell;      // of every body: mean area that a point of its surface stands for [m^2]
  View<const double> creeps;    // creep distance of every environment [m]
  // The points of which body hold for a sample; and 1 where their weights add up to that, else -1.
  MORTISE_HD bool second(const ContactSample& s) const { return s.body_b < cell.n && cell[s.body_b] < cell[s.body_a]; }
  MORTISE_HD double side(const ContactSample& s) const { return second(s) || model::against_obstacle(s) ? 1 : -1; }
  MORTISE_HD bool holds(const ContactSample& s, Index k) const {
    if (s.body_a == s.body_b) return s.weight[k] < 0;
    return body[s.point[k]] == (second(s) ? s.body_b : s.body_a);
  }
  MORTISE_HD Vec3 of(const ContactSample& s, Index k) const {
    if (!holds(s, k)) return Vec3::Zero();
    return creeps[s.env] * deflection[s.point[k]];
  }
};

// Views of the frozen samples in terms of blocks: sample i moves by P sum_b W_b (q_b - q0_b), and slips by that and its anchor.
struct Slips {
  View<const Index> offset, block;
  View<const double> weight;
  View<const FrozenContact> frozen;
  View<const Vec3> q0;
  AnchorsView anchors;
  View<const ContactSample> sample;
  Index size() const { return frozen.n; }
  MORTISE_HD double creep(Index i) const { return anchors.creeps[sample[i].env]; }
  MORTISE_HD Vec3 moved(Index i, Positions q) const { return across(i, q, Vec3::Zero()); }
  MORTISE_HD Vec3 slip(Index i, Positions q) const { return across(i, q, frozen[i].anchor); }
  MORTISE_HD Vec3 across(Index i, Positions q, Vec3 r) const {
    for (Index k = offset[i]; k < offset[i + 1]; ++k) r += weight[k] * (q[block[k]] - q0[block[k]]);
    const Vec3 n = frozen[i].normal;
    return r - n.dot(r) * n;
  }
};

// The piece of a sample of which only the force is known to change: d(mu lambda) = -mu stiffness n . sum_b W_b dq_b.
MORTISE_HD inline void follow_force(const Slips& s, const ContactSample& sample, Index i, Positions q, Vec3* left, Vec3* right) {
  const Vec3 u = s.slip(i, q), pull = f1_over_x(u.norm(), s.creep(i)) * u;
  for (Index b = 0; b < s.offset[i + 1] - s.offset[i]; ++b) {
    const double w = s.weight[s.offset[i] + b];
    left[b] = (-w * s.frozen[i].mu * sample.stiffness) * pull;
    right[b] = w * s.frozen[i].normal;
  }
}

// Fills pattern, block weights and loads from the samples; view: what is known of them; mu: per pair.
void freeze(const model::PointMapView& map, const device::Buffer<ContactSample>& samples, const model::ContactView& view, View<const double> mu,
            geometry::BodyPairsView pairs, const AnchorsView& anchors, linalg::StencilSet& stencils, device::Buffer<double>& weights,
            device::Buffer<FrozenContact>& frozen);
// What friction does at a sample.
struct Rub {
  Vec3 force, slip;  // on the first body [N]; how far that moved against the second in the step [m]
  bool sticks;       // the force is below mu times the normal one
};
std::vector<Rub> measure(const Slips& slips, Positions q);

}  // namespace mortise::effects::friction
