#pragma once
// Every number of the contact effects' common parts that was chosen, with its reason. Those of mortar_contact stand in its own.

namespace mortise::effects::contact::tuning {

// ---- the default support radius (layer.h)
inline constexpr double kFine = 0.1;        // share of edges that are shorter than the length of an edge that counts
inline constexpr double kSmooth = 0.5;      // [rad] between triangles of a round surface; ridges are bent by more
inline constexpr double kOfExtent = 0.1;    // triangles of stiff bodies are as large as their faces, and say nothing about their size
inline constexpr double kThickness = 0.01;  // d_hat over edge, if facets are no deeper,
inline constexpr double kOverFacets = 2;    // else over their depth,
inline constexpr double kThickest = 0.03;   // up to this over the edge: deeper facets are shape, not error
inline constexpr double kThinnest = 1e-3;   // and down to this where bodies begin so near to each other
inline constexpr double kRigid = 1e6;       // kappa where nothing is soft [Pa]: a gel's

// ---- ranges of barrier_contact (pair_energy.h)
inline constexpr double kEdgeRange = 0.25;  // edge_range / d_hat when area-weighted: edges only guard what points cannot see
inline constexpr double kSelfRange = 0.5;   // of the distance at rest: a body does not push itself apart before it deforms

// ---- search and steps (proximity.h, candidates.h, prescribed.h)
// Share of every distance that a step may not use up. Less brings pairs that come into range deep into the barrier, one after the other, each
// stiffer than the last, while Newton's method only doubles a gap in an iteration; more takes longer to come near.
inline constexpr double kKeep = 0.3;
inline constexpr double kMargin =
    0.5;  // of the reach: pairs are searched so much farther, so that positions a little off the path need no new search
inline constexpr double kTouch = 1e-6;  // share of a distance that counts as none left between bodies that nothing can move

// ---- nodal_pressure.h
// Cosine of a triangle's normal to the force, over the best one around the point. Sides that bulge by up to 20 degrees stay below; both sides of a
// pressed ridge are above unless one of them is three times as large.
inline constexpr double kFaces = 0.35;

}  // namespace mortise::effects::contact::tuning
