#pragma once
// `gap: averaged`: one barrier per slave node a instead of one per sample,
//     E = sum_a kappa A_a b(g_a),   A_a = sum w N_a,   g_a = sum w N_a g / A_a,
// summed over all face samples near it, also beyond d_hat. The pressure, lambda = sum_a N_a kappa phi(g_a / d_hat), is then as smooth
// as the slave's mesh and depends less on kappa where that is too stiff for the samples (README). Forces are those of
// the samples with this pressure; the Hessian has one rank-one term kappa A_a b''(g_a) G_a G_a^T, G_a = sum w N_a J / A_a, per node, over
// all that the node's samples hang on. Samples of ridges and tips keep their own barrier. All samples must keep a positive gap.
#include "effects/contact/barrier.h"
#include "effects/mortar_contact/functionals.h"

namespace mortise::effects::mortar {

// Does the sample act through the averages?
MORTISE_HD inline bool is_averaged(const Settings& set, const Pair& p, const Sample& s) {
  return set.averaged && s.kind == SampleKind::face && s.gap < tuning::kAverageReach * p.d_hat;
}

// Averages and pressures of frozen samples.
void average(const MortarView& s, FrozenSamples& f);

// Adds the nodes' energy at y; +infinity where an average is not positive.
void averaged_energy(const MortarView& s, const FrozenSamples& f, View<const Vec3> y, const std::vector<std::uint8_t>& whose,
                     device::EnvValues per_env);

// G_a by blocks: node i owns entries [offset[i], offset[i+1]).
struct NodeStencils {
  Buffer<Index> offset, block;
  Buffer<Vec3> G;
};
// What the averages change by beyond G_a . dy, `right` [1], and the change of minus the forces that comes of it, `left` [N/m], by blocks as above.
struct NodePieces {
  Buffer<Index> offset, block;
  Buffer<Vec3> left, right;
};
// Shapes `beside`: a stencil for every sample, as contact::shape does, and then one for every node.
void shape_with_nodes(const MortarView& s, const FrozenSamples& f, model::SampleChanges& changes, const model::PointMapView& map, NodePieces& nodes,
                      linalg::StencilSet& beside);

// What the pressure of a sample changes by with functional c (functionals.h), nodes' averages as they are [Pa].
struct PressureOf {
  Settings set;
  View<const double> kappa, gap;
  View<const Index> node;
  PressureOf(const MortarView& s, const FrozenSamples& f) : set(s.set), kappa(s.kappa), gap(f.averages.gap.view()), node(f.averages.node.view()) {}
  MORTISE_HD double at(const Pair& p, const Sample& s, int a) const {
    return -kappa[p.interface] * barrier::first(gap[node[3 * s.pair + a]], p.d_hat);
  }
  MORTISE_HD double by(const Pair& p, const Sample& s, Index c, View<const Vec3> y) const {
    if (!is_averaged(set, p, s)) return -kappa[p.interface] * barrier::second(s.gap, p.d_hat) * gap_by(p, s, c, y);
    const int j = static_cast<int>(c - kFirstMoved);
    return j == 0 || j == 1 ? at(p, s, j + 1) - at(p, s, 0) : 0;
  }
};

void node_stencils(const MortarView& s, const FrozenSamples& f, const model::PointMapView& map, NodeStencils& out);

}  // namespace mortise::effects::mortar
