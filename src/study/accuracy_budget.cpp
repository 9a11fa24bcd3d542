#include "study/accuracy_budget.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "study/tuning.h"

namespace mortise::study {

KnobErrors knob_errors(const std::string& certificate, const std::vector<Quantity>& quantities, const std::vector<AutoKnob>& knobs) {
  KnobErrors out;
  out.left.assign(knobs.size(), std::vector<double>(quantities.size(), 0.0)), out.rest.assign(quantities.size(), 0.0);
  const auto json = nlohmann::json::parse(certificate, nullptr, false);
  const auto none = [&](const std::string& why) { return out.why_not = why, out; };
  if (!json.is_object() || !json.contains("error_budget")) return none("the certificate has no error budget");
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    const auto& all = json["error_budget"];
    const auto of = std::find_if(all.begin(), all.end(), [&](const auto& b) { return b.value("quantity", "") == quantities[q].name; });
    if (of == all.end()) return none("there is no error budget of '" + quantities[q].name + "'");
    if (const std::string why = of->value("why_not", ""); !why.empty()) return none("'" + quantities[q].name + "': " + why);
    std::vector<bool> told(knobs.size(), false);
    for (const auto& part : of->at("parts")) {
      const std::string source = part.value("source", "");
      const auto knob = std::find_if(knobs.begin(), knobs.end(), [&](const AutoKnob& k) { return std::count(k.sources.begin(), k.sources.end(), source); });
      if (!part["error"].is_number()) {
        if (knob != knobs.end()) return none(source + ": " + part.value("why_not", ""));
        continue;
      }
      const double error = part["error"].get<double>();
      if (knob == knobs.end()) {
        out.rest[q] += error;
      } else {
        out.left[static_cast<std::size_t>(knob - knobs.begin())][q] += error;
        told[static_cast<std::size_t>(knob - knobs.begin())] = true;
      }
    }
    for (std::size_t k = 0; k < knobs.size(); ++k)
      if (!told[k]) return none("error budgets do not tell what is left by " + knobs[k].name);
  }
  return out;
}

double order_between(const Known& coarse, const Known& fine, std::size_t k, std::size_t q) {
  const double before = coarse.errors.left[k][q], now = fine.errors.left[k][q];
  const double order = std::log(before / now) / std::log(coarse.sizes[k] / fine.sizes[k]);
  return std::isfinite(order) ? std::clamp(order, tuning::kLeastOrder, tuning::kMostOrder) : 1;
}

double come_over_foretold(const Known& coarse, const Known& fine, std::size_t q) {
  double foretold = coarse.errors.rest[q] - fine.errors.rest[q];
  for (std::size_t k = 0; k < fine.errors.left.size(); ++k) foretold += coarse.errors.left[k][q] - fine.errors.left[k][q];
  return (fine.values[q] - coarse.values[q]) / foretold;
}

}  // namespace mortise::study
