#pragma once
// How fast what sticks may give way, where the scene does not say: 1e-5 m/s. That is less than a micrometre in a step, and if all contact moved on
// all the time, in a second what nobody sees in scenes of millimetres and more; in smaller ones no more than the contact layer is thick (in statics:
// over the whole load), as its thickness is what nobody sees there. Without anchors and with 1e-5 m/s a ball dragged by 30 nm over a pad of 3 um had
// 1 % of the friction that the same scene has in millimetres.
#include <algorithm>

#include "effects/contact/layer.h"
#include "effects/friction/tuning.h"

namespace mortise::effects::friction {

// `creep_speed` of the effect with these parameters (its block in the scene of the first environment), or what fits the contact that it
// follows [m/s].
inline double creep_speed(const Params& effect, const model::ModelInput& input, Index env = 0) {
  const Params& own = input.effect_of(effect, env);
  if (const Params* given = own.find("creep_speed")) return given->as_number();
  const Params* contact = input.scene.at("effects").find(own.text("follows"));
  if (!contact) return tuning::kCreepSpeed;
  return std::min(tuning::kCreepSpeed, contact::support_radius(input.effect_of(*contact, env), input, env));  // in 1 s, or the whole pseudo-time
}

}  // namespace mortise::effects::friction
