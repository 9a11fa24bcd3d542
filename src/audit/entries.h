#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/params.h"
#include "effects/roles.h"
#include "effects/tie_name.h"

namespace mortise::audit {

// Entries of an effect that is a list, such as `pin`; none where the scene does not name it. effects: the block of that name.
inline std::vector<Params> entries(const Params& effects, const char* effect) {
  const Params* list = effects.find(effect);
  return list ? list->items() : std::vector<Params>();
}

inline std::optional<Params> joint_named(const Params& effects, const std::string& name) {
  for (const Params& joint : entries(effects, "joint"))
    if (effects::tie_name(joint) == name) return joint;
  return {};
}

// Is anything told to move, by a pin or a kinematic drive?
inline bool told_to_move(const Params& effects) {
  for (const Params& pin : entries(effects, "pin"))
    if (pin.has("motion")) return true;
  for (const Params& drive : entries(effects, "drive"))
    if (drive.text("mode") == "kinematic") return true;
  return false;
}

// Bodies with loads of their own, or pins that go. What pulls at all for ever, as gravity does, is no list.
inline std::set<std::string> worked_on(const Params& effects) {
  std::set<std::string> out;
  std::vector<std::string> lists = effects::of_role(effects, effects::Role::load);
  lists.emplace_back("pin");
  for (const std::string& list : lists)
    if (const Params* of = effects.find(list); of && of->kind() == Params::Kind::list)
      for (const Params& p : of->items())
        if (list != "pin" || p.has("motion")) out.insert(p.text("body"));
  return out;
}

}  // namespace mortise::audit
