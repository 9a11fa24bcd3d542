#include "run/asked.h"

#include <algorithm>
#include <iterator>

#include "effects/drive/target.h"
#include "effects/roles.h"
#include "effects/tie_name.h"
#include "run/tuning.h"

namespace mortise::run {
namespace {

using effects::drive::Quantity;
using effects::drive::Target;

bool slides(const Params& effects, const std::string& joint) {
  const Params* list = effects.find("joint");
  if (!list) return false;
  return std::any_of(list->items().begin(), list->items().end(),
                     [&](const Params& p) { return effects::tie_name(p) == joint && p.text("type") == "prismatic"; });
}

void ask(std::vector<Asked>& out, const Schedule& schedule) { out.push_back({schedule, schedule.keys()}); }

// The same component of every key, or the number that each is.
void ask(std::vector<Asked>& out, const Params& motion, const Params& list, int component = -1) {
  Params values = Params::make_list(), table = Params::make_table();
  for (const Params& key : list.items()) values.push(Params::make_number(component < 0 ? key.as_number() : key.as_vec3()[component]));
  table.set("time", motion.at("time"));
  table.set("value", values);
  ask(out, Schedule(table, motion.text("interpolation") == "smooth"));
}

}  // namespace

std::vector<Asked> asked_of_drives_and_loads(const Params& effects) {
  std::vector<Asked> out;
  if (const Params* drives = effects.find("drive"))
    for (const Params& p : drives->items()) {
      if (!Target::any(p) || p.has("gait")) continue;
      const bool slide = slides(effects, p.text("joint"));
      const Target target(p, p.text("mode") == "effort" ? (slide ? Quantity::force : Quantity::torque) : slide ? Quantity::travel : Quantity::angle);
      out.push_back({target, target.keys()});
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

std::vector<Asked> asked_of_pins(const Params& effects) {
  std::vector<Asked> out;
  const Params* pins = effects.find("pin");
  if (!pins) return out;
  for (const Params& pin : pins->items()) {
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

std::vector<Phase> phases(const Params& effects) {
  std::vector<Asked> all = asked_of_pins(effects);
  for (Asked& asked : asked_of_drives_and_loads(effects)) all.push_back(std::move(asked));
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

}  // namespace mortise::run
