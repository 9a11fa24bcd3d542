// What is asked for: names of numbers, and how accurate they are to be.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/suggest.h"
#include "study/accuracy.h"
#include "study/read.h"
#include "study/tuning.h"

namespace mortise::study {

Goal goal_of_flag(const std::string& text) {
  const std::size_t eq = text.rfind('=');
  const auto wrong = [&](const std::string& why) { return Error(Exit::usage, "--accuracy " + text + ": " + why); };
  if (eq == std::string::npos || eq == 0 || eq + 1 == text.size()) throw wrong("write NAME=PERCENT of a quantity of the scene, e.g. peak=1%");
  Goal out{text.substr(0, eq), 0};
  std::string number = text.substr(eq + 1);
  if (number.back() != '%') throw wrong("'" + number + "' is no percentage; write " + out.quantity + "=1%");
  number.pop_back();
  while (!number.empty() && number.back() == ' ') number.pop_back();
  std::size_t used = 0;
  try {
    out.share = std::stod(number, &used) / 100;
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != number.size()) throw wrong("'" + text.substr(eq + 1) + "' is no percentage");
  if (!(out.share >= tuning::kFinestGoal && out.share <= tuning::kCoarsestGoal))
    throw wrong(fmt::format("must be between {:g} % and {:g} %", 100 * tuning::kFinestGoal, 100 * tuning::kCoarsestGoal));
  return out;
}

double Accuracy::goal(std::size_t q, double value) const {
  return std::max(goals[q].share * std::max(std::abs(value), quantities[q].scale), tuning::kRounding);
}

std::vector<Quantity> quantities_of_goals(const Params& scene, const std::vector<Goal>& goals) {
  const std::vector<Quantity> all = quantities_of(scene);
  if (all.empty())
    throw Error(
        Exit::usage,
        "--accuracy: the scene names no number to be accurate in; write 'quantities: [{name: peak, value: contact_pressure, body: pad, over: max}]' "
        "into it (src/study/README.md)");
  std::vector<std::string> names;
  for (const Quantity& q : all) names.push_back(q.name);
  std::vector<Quantity> out;
  for (const Goal& g : goals) {
    const auto found = std::find(names.begin(), names.end(), g.quantity);
    if (found == names.end())
      throw Error(Exit::usage,
                  fmt::format("--accuracy: the scene's 'quantities' have no '{}'\n  {}", g.quantity, scene::suggestion(g.quantity, names)));
    for (const Quantity& q : out)
      if (q.name == g.quantity) throw Error(Exit::usage, "--accuracy names '" + g.quantity + "' twice");
    out.push_back(all[static_cast<std::size_t>(found - names.begin())]);
  }
  return out;
}

}  // namespace mortise::study
