#pragma once
// The samples of a contact effect as friction has them: how far each slips, and what of it is frozen while Newton iterates.
#include "effects/effect.h"
#include "effects/friction/law.h"
#include "geometry/body_pairs.h"
#include "linalg/stencils.h"
#include "model/contact_view.h"

namespace mortise::effects::friction {

using model::ContactSample;

// What is frozen of a sample during Newton.
struct FrozenContact {
  Vec3 normal;
  double mu, load;  // load: mu times the normal force [N]
};

// Views of the frozen samples in terms of blocks: sample i slips by P sum_b W_b (q_b - q0_b).
struct Slips {
  View<const Index> offset, block;
  View<const double> weight;
  View<const FrozenContact> frozen;
  View<const Vec3> q0;
  View<const double> creeps;  // of every environment: creep distance of a step [m]
  View<const ContactSample> sample;
  Index size() const { return frozen.n; }
  MORTISE_HD double creep(Index i) const { return creeps[sample[i].env]; }
  MORTISE_HD Vec3 slip(Index i, Positions q) const {
    Vec3 r = Vec3::Zero();
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
            geometry::BodyPairsView pairs, linalg::StencilSet& stencils, device::Buffer<double>& weights, device::Buffer<FrozenContact>& frozen);
// Friction force on the first body of every sample [N], and then the slips of all against the second [m].
std::vector<Vec3> measure(const Slips& slips, const device::Buffer<ContactSample>& samples, Positions q);

}  // namespace mortise::effects::friction
