#include "study/orders.h"

#include <algorithm>

#include "study/plan.h"

namespace mortise::study {
namespace {

constexpr const char* kOrder = ".order";

bool varies(const Ladder& ladder, auto what) {
  const Settings& knobs = ladder.steps.front().settings;
  return std::any_of(knobs.begin(), knobs.end(), [&](const auto& setting) { return what(setting.first); });
}

// Are all of its knobs orders of bodies?
bool of_orders(const Ladder& ladder) {
  return !varies(ladder, [](const std::string& path) { return !path.starts_with("bodies.") || !path.ends_with(kOrder); });
}

bool beside_its_mesh(const Ladder& order, const std::vector<Ladder>& ladders) {
  return varies(order, [&](const std::string& path) {
    const std::string shape = path.substr(0, path.size() - std::string(kOrder).size()) + ".shape.";
    const auto of_mesh = [&](const std::string& other) { return other.starts_with(shape) && other.ends_with("edge_length"); };
    return std::any_of(ladders.begin(), ladders.end(), [&](const Ladder& l) { return varies(l, of_mesh); });
  });
}

std::vector<Method> with_orders(const std::vector<Method>& methods, const Ladder& order) {
  std::vector<Method> out;
  for (const Method& m : methods)
    for (auto step = order.steps.rbegin(); step != order.steps.rend(); ++step) {
      Method& with = out.emplace_back(m);
      with.name += (m.name.empty() ? "" : ", ") + step_label(order, *step);
      with.at = order.at;
      for (const auto& [path, value] : step->settings) with.set.push_back(path + "=" + value);
    }
  return out;
}

}  // namespace

Study orders_apart(Study study) {
  for (std::size_t l = study.ladders.size(); l-- > 0;) {
    const Ladder order = study.ladders[l];
    if (!of_orders(order) || !beside_its_mesh(order, study.ladders)) continue;
    study.ladders.erase(study.ladders.begin() + static_cast<std::ptrdiff_t>(l));
    study.methods = with_orders(study.methods, order);
  }
  return study;
}

}  // namespace mortise::study
