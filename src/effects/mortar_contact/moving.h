#pragma once
// How samples turn and slide with the surfaces, which their frozen energy does not know: derivatives of every sample's barycentrics and weight by the
// places of its pair's nodes, and what they add to the Jacobian of the contact forces f_k = w p J_k, J = (M_b n, -N_a n),
//
//     d f_k = d(w p) J_k + w p dJ_k,                        d(w p) = p dw - kappa w b'' dg,
//     dg    = sum_k J_k . dy_k + n . (x_m,j dM_j - x_s,j dN_j),        x_s,j = d x_s / d N_j,
//     dJ_a  = -S_a,j dN_j n - S_a dn,  dJ_b = S_b,j dM_j n + S_b dn,   dn = -g_j (n . de_j),   g_i . e_j = delta_ij, g_i . n = 0,
//
// less kappa w b'' J J^T, which is the frozen Hessian. S are the shape functions of the nodes, e_1 and e_2 the sides of the slave triangle.
//
// dN, dM and dw come from the very program that takes the samples (sampling.h), run with jets in what a slave and a master are to each other: the
// barycentrics and heights of the master's corners, the shape of the slave and the angle between them. Nodes move these by formulas (pull below).
// Left out: what the nodes of neighbours do (to how a slave is bent, to areas and angles of the triangles around an edge or a tip, and to what hides
// layers), the three-term gradient and averaged gaps; `complete` says where nothing is.
#include "effects/mortar_contact/stage.h"
#include "linalg/rank_ones.h"

namespace mortise::effects::mortar {

template <class Weights>
void find_moving(const Stage& stage, const Weights& weights, const Places& places, FrozenSamples& out);

// Adds to every pair's stencil of `set` (frozen.h) what its samples' motion adds to the Jacobian of -f.
void follow(const MortarView& s, const FrozenSamples& f, const model::PointMapView& map, linalg::StencilSet& set, linalg::RankOnes& out);

// How what is published of every sample changes.
void sample_changes(const MortarView& s, const FrozenSamples& f, model::SampleChanges& out);

// Is that all of the Jacobian?
bool complete(const MortarView& s, const FrozenSamples& f);

}  // namespace mortise::effects::mortar
