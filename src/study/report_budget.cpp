// What is told of an error budget.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/version.h"
#include "study/error_budget.h"
#include "study/report.h"

namespace mortise::study {
namespace {

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
    out += fmt::format("  {:40} {:>+13.4g} {:>11}   so about {:.5g}\n\n", b.complete() ? "all" : "all that is estimated", b.sum(),
                       share_text(b.sum(), b.value), b.value + b.sum());
  }
  out += fmt::format("{} of CPU time in the steps, {} for the estimates\n", seconds_text(budget.solve_seconds), seconds_text(budget.seconds));
  if (!budget.exact) out += "the adjoint leaves out that samples of contact slide and turn\n";
  return out;
}

std::string budget_json(const Study& study, const ErrorBudget& budget) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  Json j{{"filetype", "mortise error budget"}, {"version", version()}, {"scene", study.scene}, {"adjoint_is_exact", budget.exact}};
  j["cpu_seconds"] = {{"steps", budget.solve_seconds}, {"estimates", budget.seconds}};
  j["quantities"] = Json::array();
  for (std::size_t k = 0; k < study.quantities.size(); ++k) {
    const QuantityBudget& b = budget.of[k];
    Json parts = Json::array();
    for (const ErrorPart& p : b.parts) parts.push_back({{"source", p.source}, {"error", number(p.error)}, {"why_not", p.why_not}});
    j["quantities"].push_back({{"name", study.quantities[k].name},
                               {"value", number(b.value)},
                               {"why_not", b.why_not},
                               {"parts", parts},
                               {"error", b.why_not.empty() ? number(b.sum()) : Json(nullptr)},
                               {"complete", b.why_not.empty() && b.complete()}});
  }
  return j.dump(1) + "\n";
}

}  // namespace mortise::study
