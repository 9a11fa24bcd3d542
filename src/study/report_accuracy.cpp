// What is told of the way to an accuracy.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/version.h"
#include "output/json_number.h"
#include "study/accuracy.h"
#include "study/report.h"

namespace mortise::study {
namespace {

using Tree = nlohmann::ordered_json;

std::string percent(double error, double value) {
  if (!std::isfinite(error)) return "not reliable";
  return value != 0 ? fmt::format("{:.2g} %", 100 * error / std::abs(value)) : fmt::format("{:.2g}", error);
}

}  // namespace

std::string accuracy_table(const Accuracy& a) {
  std::string out = fmt::format("  {:44} {:>10}", "run", "CPU time");
  for (const Quantity& q : a.quantities) out += fmt::format("  {:>22}", q.name + ", error");
  out += "\n";
  for (std::size_t i = 0; i < a.attempts.size(); ++i) {
    const Attempt& t = a.attempts[i];
    out += fmt::format("{} {:44} {:>10}", i == a.chosen ? "*" : " ", t.run.label, t.run.failed() ? "" : seconds_text(t.run.process));
    if (t.run.failed()) {
      out += "  failed: " + t.run.message + "\n";
      continue;
    }
    for (std::size_t q = 0; q < a.quantities.size(); ++q)
      out += fmt::format("  {:>22}", t.estimates.empty() ? fmt::format("{:.5g}, -", t.run.values[q])
                                                         : fmt::format("{:.5g}, {}", t.run.values[q], percent(t.estimates[q], t.run.values[q])));
    out += "\n";
  }
  const Attempt& best = a.attempts[a.chosen];
  for (std::size_t q = 0; q < a.quantities.size(); ++q) {
    out += fmt::format("{} = {:.6g}, estimated error {} of {:g} % asked; left by", a.quantities[q].name, best.run.values[q],
                       percent(best.estimates[q], best.run.values[q]), 100 * a.goals[q].share);
    for (std::size_t k = 0; k < a.climbs.size(); ++k)
      out += fmt::format("{} {} {}", k == 0 ? "" : ",", a.knobs[k], percent(a.climbs[k].error(q, 0), best.run.values[q]));
    out += "\n";
    if (!settles(a.climbs, q, a.goal(q, best.run.values[q])))
      out += "  not settled: this is what it scatters by from run to run, and says little of how wrong it is\n";
    if (a.quantities[q].reference)
      out += fmt::format("  against its reference of {:.6g}: {}\n", *a.quantities[q].reference,
                         percent(std::abs(best.run.values[q] - *a.quantities[q].reference), *a.quantities[q].reference));
  }
  out += "estimated by " + a.how + "\n";
  for (const std::string& n : a.notes) out += "note: " + n + "\n";
  if (!a.doubt.empty()) out += "the estimates may miss what the certificate of that run is graded for, " + a.doubt + "\n";
  out += a.reached ? "reached" : "not reached: " + a.why_not;
  return out + fmt::format("; {} of CPU time in all\n", seconds_text(a.seconds));
}

std::string accuracy_json(const Accuracy& a) {
  Tree j{{"filetype", "mortise accuracy"}, {"mortise_version", version()}, {"reached", a.reached},
         {"why_not", a.why_not},           {"estimated_by", a.how},        {"doubt", a.doubt},
         {"cpu_seconds", a.seconds}};
  j["goals"] = Tree::array(), j["runs"] = Tree::array(), j["settings"] = Tree::object();
  for (const auto& [path, value] : a.settings) j["settings"][path] = value;
  for (std::size_t q = 0; q < a.goals.size(); ++q) {
    Tree left = Tree::object();
    for (std::size_t k = 0; k < a.climbs.size(); ++k) left[a.knobs[k]] = output::number_or_null(a.climbs[k].error(q, 0));
    j["goals"].push_back({{"quantity", a.goals[q].quantity},
                          {"asked", a.goals[q].share},
                          {"value", output::number_or_null(a.attempts[a.chosen].run.values[q])},
                          {"estimated_error", output::number_or_null(a.attempts[a.chosen].estimates[q])},
                          {"settled", settles(a.climbs, q, a.goal(q, a.attempts[a.chosen].run.values[q]))},
                          {"left_by", left}});
  }
  for (std::size_t i = 0; i < a.attempts.size(); ++i) {
    const Attempt& t = a.attempts[i];
    Tree values = Tree::array(), errors = Tree::array();
    for (std::size_t q = 0; q < a.goals.size(); ++q)
      values.push_back(output::number_or_null(t.run.values[q])),
          errors.push_back(t.estimates.empty() ? Tree(nullptr) : output::number_or_null(t.estimates[q]));
    j["runs"].push_back({{"id", t.run.id},
                         {"label", t.run.label},
                         {"chosen", i == a.chosen},
                         {"exit_code", t.run.code},
                         {"message", t.run.message},
                         {"cpu_seconds", output::number_or_null(t.run.process)},
                         {"dofs", t.run.dofs},
                         {"values", values},
                         {"estimated_errors", errors}});
  }
  return json_text(j, 1) + "\n";
}

}  // namespace mortise::study
