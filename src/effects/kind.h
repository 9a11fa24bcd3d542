#pragma once
// A kind of effect: what scenes call it, and the traits by which all others treat it. Nobody asks an effect for its name.
#include <memory>
#include <string>
#include <vector>

#include "base/param_table.h"
#include "base/params.h"

namespace mortise::model {
class Model;
}

namespace mortise::effects {

class Effect;

enum class Role {
  support,  // holds or moves blocks; no energy
  tie,  // ties blocks to others (model/ties.h), and holds what energy its stops have. A list, of which every entry names a `body` and one that it is
        // tied `to`
  inertia,  // resists acceleration: makes a scene dynamic; its potential is no store
  load,     // forces from outside; its potential is no store
  motor,    // forces that come and go: energy() is that of one step; their work counts with that of supports, but for what they hold
            // (Effect::held_energy)
  store,    // energy that bodies hold; its forces on every body cancel
  contact,  // energy between bodies; has samples, and a key d_hat in the scene
  follower  // acts on the samples of the contact effect that its key `follows` names
};

struct Kind {
  const char* name;
  Role role;
  const char* help;  // one line
  const ParamTable* table;
  std::unique_ptr<Effect> (*make)(const Params&, model::Model&);
  std::vector<std::string> papers{};                       // printed by --citations
  std::vector<std::string> point_fields{}, cell_fields{};  // that it reports: what scenes may keep and colour by
  // Its forces are the gradient of energy(), and linearise() freezes nothing: the Jacobian is the symmetric matrix that it finds.
  bool symmetric = true;
  // It has quantities that are frozen while Newton iterates, and keys lag_tolerance and lag_iterations that say how well that is resolved.
  bool lags = false;
  // Keys of its block, or of its entries, whose numbers the environments of one model may differ in; it reads each from its own scene then
  // (ModelInput::effect_of).
  std::vector<const char*> own{};
  Kind differing_in(std::vector<const char*> keys) const {
    Kind out = *this;
    out.own = std::move(keys);
    return out;
  }

  bool stores_energy() const { return role == Role::store || role == Role::contact || role == Role::tie; }
};

}  // namespace mortise::effects
