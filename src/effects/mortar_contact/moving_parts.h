#pragma once
// Stages of find_moving (moving.h): which nodes samples hang on, and what is not in the program that takes them.
#include "effects/mortar_contact/moving.h"

namespace mortise::effects::mortar {

// Why a sample is followed in part only: it is not found again, or there is no room for its nodes; others hide some of it.
inline constexpr std::uint8_t kLost = 1, kHidden = 2;

// Which nodes every sample hangs on; nothing moves yet.
void find_nodes(const Stage& stage, const model::PointMapView& point_map, FrozenSamples& out);

// What other masters hide of a sample changes with their places, the slave's, and its own. Its weight is w v, v = 1 - sum of shares, of which dw is
// in.
void follow_layers(const Stage& stage, FrozenSamples& out);

// Between curved faces the other point of a sample stays above or below the first along n:  x_m(M) - x_s(N) = g n.
void slide(const MortarView& view, View<const Vec3> y, FrozenSamples& out);

}  // namespace mortise::effects::mortar
