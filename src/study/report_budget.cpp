// What is told of an error budget.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/version.h"
#include "output/json_number.h"
#include "study/error_budget.h"
#include "study/report.h"

namespace mortise::study {
namespace {

using Json = nlohmann::ordered_json;

std::string share_text(double error, double value) { return value != 0 ? fmt::format("{:+.3g} %", 100 * error / std::abs(value)) : ""; }

}  // namespace

std::string budget_table(const Study& study, const ErrorBudget& budget) {
  std::string out;
  for (std::size_t k = 0; k < study.quantities.size(); ++k) {
    const QuantityBudget& b = budget.of[k];
    out += fmt::format("{} = {:.6g}\n", study.quantities[k].name, b.value);
    if (!b.why_not.empty()) {
      out += "  not estimated: " + b.why_not + "\n\n";
      continue;
    }
    out += fmt::format("  {:40} {:>13} {:>11}\n", "because of", "to be added", "share");
    for (const ErrorPart& part : b.parts)
      out += std::isfinite(part.error) ? fmt::format("  {:40} {:>+13.4g} {:>11}\n", part.source, part.error, share_text(part.error, b.value))
                                       : fmt::format("  {:40} not estimated: {}\n", part.source, part.why_not);
    const auto known = [](const ErrorPart& p) { return std::isfinite(p.error); };
    const bool reliable = std::none_of(b.parts.begin(), b.parts.end(), [](const ErrorPart& p) { return p.why_not.starts_with(kNotReliable); });
    if (std::any_of(b.parts.begin(), b.parts.end(), known))
      out += fmt::format("  {:40} {:>+13.4g} {:>11}{}\n", b.complete() ? "all" : "all that is estimated", b.sum(), share_text(b.sum(), b.value),
                         reliable ? fmt::format("   so about {:.5g}", b.value + b.sum()) : "");
    out += "\n";
  }
  out += budget.seconds > 0
             ? fmt::format("{} of CPU time in the steps, {} for the estimates\n", seconds_text(budget.solve_seconds), seconds_text(budget.seconds))
             : fmt::format("{} of CPU time in the steps, estimates included\n", seconds_text(budget.solve_seconds));
  if (!budget.note.empty()) out += "note: " + budget.note + "\n";
  if (!budget.exact) out += "the adjoint leaves out some of how samples of contact slide and turn\n";
  return out;
}

std::string budget_entries(const std::vector<Quantity>& quantities, const ErrorBudget& budget) {
  Json out = Json::array();
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    const QuantityBudget& b = budget.of[k];
    Json parts = Json::array();
    for (const ErrorPart& p : b.parts) parts.push_back({{"source", p.source}, {"error", output::number_or_null(p.error)}, {"why_not", p.why_not}});
    const bool known = b.why_not.empty();
    out.push_back({{"quantity", quantities[k].name},
                   {"value", output::number_or_null(b.value)},
                   {"error", known ? output::number_or_null(b.sum()) : Json(nullptr)},
                   {"complete", known && b.complete()},
                   {"why_not", b.why_not},
                   {"adjoint_is_exact", budget.exact},
                   {"parts", parts}});
  }
  return json_text(out);
}

std::string budget_json(const Study& study, const ErrorBudget& budget) {
  Json j{{"filetype", "mortise error budget"}, {"mortise_version", version()}, {"scene", study.scene}};
  if (!budget.note.empty()) j["note"] = budget.note;
  j["cpu_seconds"] = {{"steps", budget.solve_seconds}, {"estimates", budget.seconds}};
  j["quantities"] = Json::parse(budget_entries(study.quantities, budget));
  return json_text(j, 1) + "\n";
}

}  // namespace mortise::study
