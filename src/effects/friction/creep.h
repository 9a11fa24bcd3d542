#pragma once
// How far what sticks gives way in a step, where the scene does not say: 1e-4 m/s times the step, but no more than a twentieth of the contact layer,
// whose thickness is what nobody sees. It does so once (anchors.h), and Newton's method takes the fewer iterations the farther it is: grips, drags
// and strips of soft pads 5 to 26 % fewer than with 1e-5 m/s, and their forces move by less than 0.5 %.
#include <algorithm>
#include <cmath>

#include "effects/contact/layer.h"
#include "effects/friction/tuning.h"

namespace mortise::effects::friction {

struct Creep {
  double speed;            // [m/s]; without motion [m] per unit of pseudo-time
  double most = INFINITY;  // in a step [m]
  double distance(double dt) const { return std::min(speed * dt, most); }
};

// Of the effect with these parameters (its block in the scene of the first environment).
inline Creep creep(const Params& effect, const model::ModelInput& input, Index env = 0) {
  const Params& own = input.effect_of(effect, env);
  if (const Params* given = own.find("creep_speed")) return {given->as_number()};
  const Params* contact = input.scene.at("effects").find(own.text("follows"));
  if (!contact) return {tuning::kCreepSpeed};
  return {tuning::kCreepSpeed, tuning::kOfLayer * contact::support_radius(input.effect_of(*contact, env), input, env)};
}

}  // namespace mortise::effects::friction
