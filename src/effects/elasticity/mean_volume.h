#pragma once
// Clusters c of linear tetrahedra that resist the mean change of their volume,
//     E = sum_c V_c lambda/2 <theta>_c^2,   <theta>_c = sum_e V_e/V_c theta_e,   p_c = lambda <theta>_c,
// with theta_e of elasticity.h. The second derivative is sum_e V_e p_c d^2 theta_e, which the tetrahedra carry themselves, and
// one term of rank one per cluster over all its nodes, lambda V_c g g^T with g = sum_e V_e/V_c d theta_e: a stencil of its own
// behind those of the tetrahedra.
#include "effects/elasticity/tets.h"

namespace mortise::effects::elasticity {

// Of the environments of `whose`; empty: of all.
using Whose = std::vector<std::uint8_t>;

// p_c of all clusters [Pa].
void cluster_pressures(const Tets& tets, const model::Clusters& clusters, Positions q, const Whose& whose, device::Buffer<double>& pressure);
void cluster_energy(const Tets& tets, const model::Clusters& clusters, Positions q, const Whose& whose, device::EnvValues per_env);
// Fills the stencils from `first` on, one per cluster: no forces, and the Hessian if wanted.
void cluster_stencils(const Tets& tets, const model::Clusters& clusters, Positions q, Index first, bool hessian, const Whose& whose,
                      const linalg::StencilView& out);

}  // namespace mortise::effects::elasticity
