#pragma once
// How samples turn and slide with the surfaces, which their frozen energy does not know: derivatives of every sample's barycentrics and weight by
// the places of nodes, and what they add to the Jacobian of the contact forces. Force w p, with p = -kappa b'(g), acts along n on the sample's
// points, with S_b(M) on those of the master and -S_a(N) on those of the slave; S are the shape functions. With the sides e_1 and e_2 of the slave
//
//     d(w p) = p dw - kappa w b'' dg,      dg = sum_k J_k . dy_k + n . (x_m,j dM_j - x_s,j dN_j),      x_s,j = d x_s / d N_j,
//     dS_a = S_a,j dN_j,   dS_b = S_b,j dM_j,   dn = -g_j (n . de_j),   g_i . e_j = delta_ij,   g_i . n = 0.
//
// The term of J alone is the frozen Hessian.
//
// dN, dM and dw come from the very program that takes the samples (sampling.h), run with jets in what a slave and a master are to each other: the
// barycentrics and heights of the master's corners, the shape of the slave, the angle between them and how the slave is bent. Nodes move these by
// formulas (Couple in moving.cpp, neighbours.h). Left out are layers over curved faces that hide a part of a sample; complete() says where nothing
// is.
//
// With the three-term gradient faces press along J = (M_b m, -N_a m - g k_a) (frozen.h), dg is as above, and so
//     m = n_m / c,   c = n . n_m,   dn_m = -g_mj (n_m . dE_j),   dc = -(g_j . n_m) (n . de_j) - (g_mj . n) (n_m . dE_j),
// dk_a by jets of its formula. Where gaps are averaged, p = sum_a N_a P_a, P_a = -kappa b'(g_a), and (averaged.h)
//     dp = sum_a P_a dN_a - kappa b''(g_a) N_a dg_a,     A_a dg_a = sum over samples (g - g_a) d(w N_a) + w N_a dg,
// so that every slave node adds a piece of rank one beyond G_a, over all that its samples hang on.
#include "effects/mortar_contact/stage.h"
#include "linalg/rank_ones.h"

namespace mortise::effects::mortar {

MovingView view_of(Motion& moving);

// Of the samples of the environments that want it. The host waits for how many nodes they hang on.
template <class Weights>
void find_moving(const Stage& stage, Moving wanted, const model::PointMapView& map, const Weights& weights, const Places& places, FrozenSamples& out);

// How what is published of every sample changes: in environments that do not want its motion with its frozen gap alone.
void sample_changes(const MortarView& s, FrozenSamples& f, model::SampleChanges& out);

// What the changes of a contact's samples add to the Jacobian of minus its forces, beyond the frozen Hessian.
void follow(const MortarView& s, const FrozenSamples& f, model::ContactView& contact, const model::PointMapView& map, linalg::StencilSet& beside,
            linalg::RankOnes& out);

// Is that all of the Jacobian?
bool complete(const FrozenSamples& f);

}  // namespace mortise::effects::mortar
