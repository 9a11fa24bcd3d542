#pragma once
// What friction does between every two bodies, from what it and the contact it follows reported of their samples.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/snapshot.h"
#include "effects/friction/creep.h"
#include "effects/roles.h"
#include "model/input.h"

namespace mortise::audit {

struct FrictionLaw {
  double creep_speed;   // what sticks creeps more slowly [m/s]
  std::string follows;  // the contact effect
};
// By effect.
std::map<std::string, FrictionLaw> friction_laws(const model::ModelInput& input);

struct FrictionPair {
  double force = 0;           // sum |F| [N]
  double power = 0;           // that friction takes away [W],
  double stuck = 0;           // of which where it sticks
  double pressed = 0;         // of the normal forces N: sum N v, v the speed of slip [W]
  double normal = 0;          // sum N [N]
  Vec3 slips = Vec3::Zero();  // sum of F where it slips [N],
  double slid = 0;            // and of |F|
  // Mean speed with which what sticks gives way, over all of friction's forces, and of the slip, over those that press [m/s].
  double creep() const { return force > 0 ? stuck / force : 0; }
  double pressed_speed() const { return normal > 0 ? pressed / normal : 0; }
};
using Bodies = std::pair<std::size_t, std::size_t>;  // by number, the smaller first; obstacles after all others

using Rubbing = std::map<Bodies, FrictionPair>;  // what one effect does in a state
std::vector<Rubbing> rubbing(const std::map<std::string, FrictionLaw>& laws, const Snapshot& said);

}  // namespace mortise::audit
