#include "audit/asked.h"

#include <algorithm>
#include <iterator>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "effects/drive/target.h"
#include "effects/roles.h"

namespace mortise::audit {
namespace {

using effects::drive::Quantity;
using effects::drive::Target;

void ask(std::vector<Asked>& out, const Schedule& schedule) { out.push_back({schedule, schedule.keys()}); }

// The same component of every key, or the number that each is.
void ask(std::vector<Asked>& out, const Params& motion, const Params& list, int component = -1) {
  Params values = Params::make_list(), table = Params::make_table();
  for (const Params& key : list.items()) values.push(Params::make_number(component < 0 ? key.as_number() : key.as_vec3()[component]));
  table.set("time", motion.at("time"));
  table.set("value", values);
  ask(out, Schedule(table, motion.text("interpolation") == "smooth"));
}

std::vector<Asked> asked_of_pins(const Params& effects) {
  std::vector<Asked> out;
  for (const Params& pin : entries(effects, "pin")) {
    const Params* motion = pin.find("motion");
    if (!motion) continue;
    if (const Params* list = motion->find("translation"))
      for (int a = 0; a < 3; ++a) ask(out, *motion, *list, a);
    if (const Params* turns = motion->find("rotation"))
      for (const Params& turn : turns->items()) ask(out, *motion, turn.at("angle"));
    if (const Params* turn = motion->find("orientation"))
      for (const char* part : {"w", "x", "y", "z"}) ask(out, *motion, turn->at(part));
  }
  return out;
}

}  // namespace

std::vector<Asked> asked_of_drives_and_loads(const Params& effects) {
  std::vector<Asked> out;
  for (const Params& p : entries(effects, "drive")) {
    if (!Target::any(p) || p.has("gait")) continue;
    const std::optional<Params> joint = joint_named(effects, p.text("joint"));
    const bool slide = joint && joint->text("type") == "prismatic";
    const bool pushes = p.text("mode") == "effort";
    const Target target(p, pushes ? (slide ? Quantity::force : Quantity::torque) : slide ? Quantity::travel : Quantity::angle);
    out.push_back({target, target.keys(), pushes});
  }
  for (const std::string& name : effects::of_role(effects, effects::Role::load)) {
    const Params& list = effects.at(name);
    if (list.kind() != Params::Kind::list) continue;
    for (const Params& load : list.items())
      for (const char* key : {"pressure", "traction_factor"})
        if (load.has(key)) ask(out, Schedule(load.at(key)));
  }
  return out;
}

std::vector<Asked> all_asked(const Params& effects) {
  std::vector<Asked> out = asked_of_pins(effects);
  for (Asked& asked : asked_of_drives_and_loads(effects)) out.push_back(std::move(asked));
  return out;
}

std::vector<Phase> phases(const Params& effects) {
  const std::vector<Asked> all = all_asked(effects);
  std::vector<double> ends;
  for (const Asked& asked : all)
    if (asked.keys.size() <= tuning::kPhases)
      std::copy_if(asked.keys.begin(), asked.keys.end(), std::back_inserter(ends), [](double t) { return t > 0; });
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<Phase> out;
  double start = 0;
  for (double end : ends) {
    out.push_back({end, std::any_of(all.begin(), all.end(), [&](const Asked& asked) { return asked.at(end) != asked.at(start); })});
    start = end;
  }
  return out;
}

}  // namespace mortise::audit
