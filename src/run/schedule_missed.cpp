#include "run/schedule_missed.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "effects/drive/target.h"
#include "effects/roles.h"
#include "effects/tie_name.h"
#include "run/moving_body.h"
#include "run/tuning.h"

namespace mortise::run {
namespace {

using effects::drive::Quantity;
using effects::drive::Target;

// What somebody asks for over time, and where it bends.
struct Asked {
  std::function<double(double)> at;
  std::vector<double> keys;
};

bool slides(const Params& effects, const std::string& joint) {
  const Params* list = effects.find("joint");
  if (!list) return false;
  return std::any_of(list->items().begin(), list->items().end(),
                     [&](const Params& p) { return effects::tie_name(p) == joint && p.text("type") == "prismatic"; });
}

std::vector<Asked> all_asked(const Params& effects) {
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
        if (load.has(key)) {
          const Schedule schedule(load.at(key));
          out.push_back({schedule, schedule.keys()});
        }
  }
  return out;
}

double missed(const Asked& asked, double h, long steps) {
  const double start = asked.at(0);
  double beside = 0, all = 0;
  std::size_t key = 0;
  std::vector<double> at;
  for (long n = 0; n < steps; ++n) {
    const double t0 = h * static_cast<double>(n), t1 = h * static_cast<double>(n + 1), s0 = asked.at(t0), s1 = asked.at(t1);
    at.clear();
    for (int k = 0; k <= tuning::kLooks; ++k) at.push_back(t0 + h * k / tuning::kLooks);
    while (key < asked.keys.size() && asked.keys[key] <= t0) ++key;
    for (std::size_t k = key; k < asked.keys.size() && asked.keys[k] < t1; ++k) at.push_back(asked.keys[k]);
    std::sort(at.begin(), at.end());
    for (std::size_t k = 1; k < at.size(); ++k) {  // by the ends of the pieces, between which it is nearly straight
      const auto away = [&](double t) { return std::abs(asked.at(t) - (s0 + (t - t0) / h * (s1 - s0))); };
      const double half = 0.5 * (at[k] - at[k - 1]);
      beside += half * (away(at[k - 1]) + away(at[k]));
      all += half * (std::abs(asked.at(at[k - 1]) - start) + std::abs(asked.at(at[k]) - start));
    }
  }
  return all > 0 ? beside / all : NAN;
}

}  // namespace

double schedule_missed(const model::ModelInput& input) {
  const double h = integration_of(input.scene).step;
  double worst = NAN;
  if (std::isnan(h)) return worst;
  const long steps = input.scene.at("time").integer("steps");
  for (const Asked& asked : all_asked(input.scene.at("effects"))) worst = std::fmax(worst, missed(asked, h, steps));
  return worst;
}

}  // namespace mortise::run
