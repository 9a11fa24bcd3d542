// Tables of what quantities hang on.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "base/csv_cell.h"
#include "study/report.h"
#include "study/sensitivity.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

// What a quantity changes by as a parameter grows by one percent.
std::string change_of_one_percent(double per_share, double value) {
  const double change = per_share / 100;
  return value != 0 ? fmt::format("{:+.4g} %", 100 * change / std::abs(value)) : fmt::format("{:+.4g}", change);
}

std::string note_of(const Derivative& d, double value) {
  if (!d.kink) return "";
  const double jump = tuning::kHair * std::max(std::abs(d.below), std::abs(d.above));
  if (value != 0 && jump > tuning::kJump * std::abs(value))
    return fmt::format("jumps there by {:.3g} %: something that is chosen by it changes", 100 * jump / std::abs(value));
  return fmt::format("no derivative: {} of +1 %, {} of -1 %", change_of_one_percent(d.above, value), change_of_one_percent(-d.below, value));
}

}  // namespace

std::string sensitivity_table(const Study& study, const Sensitivities& found) {
  std::string out;
  std::size_t wide = 20;
  for (const Sensitivity& s : found.parameters) wide = std::max(wide, s.parameter.path.size());
  for (std::size_t q = 0; q < study.quantities.size(); ++q) {
    const double value = found.values[q];
    if (!std::isfinite(value)) {
      out += fmt::format("{}: was not reported\n\n", study.quantities[q].name);
      continue;
    }
    out += fmt::format("{} = {:.6g}\n", study.quantities[q].name, value);
    out += fmt::format("  {:{}} {:>12} {:>13} {:>15}  {}\n", "parameter p", wide, "p", "dQ/dp", "Q for +1 % of p", "+-");
    std::vector<const Sensitivity*> order;
    for (const Sensitivity& s : found.parameters)
      if (s.refused.empty()) order.push_back(&s);
    std::stable_sort(order.begin(), order.end(),
                     [q](const Sensitivity* a, const Sensitivity* b) { return std::abs(a->of[q].central()) > std::abs(b->of[q].central()); });
    for (const Sensitivity* s : order) {
      const Derivative& d = s->of[q];
      if (!std::isfinite(d.central())) {
        out += fmt::format("  {:{}} is not followed\n", s->parameter.path, wide);
        continue;
      }
      const double p = s->parameter.number();
      const std::string note = note_of(d, value);
      out += fmt::format("  {:{}} {:>12} {:>13} {:>15}  {}\n", s->parameter.path, wide, std::isfinite(p) ? fmt::format("{:.6g}", p) : "all of it",
                         std::isfinite(p) && !d.kink ? fmt::format("{:.5g}", d.central() / p) : "-",
                         d.kink ? "-" : change_of_one_percent(d.central(), value),
                         d.kink ? note : fmt::format("{:.1g} %", std::abs(value != 0 ? d.uncertainty() / value : d.uncertainty())));
    }
    out += "\n";
  }
  for (const Sensitivity& s : found.parameters)
    if (!s.refused.empty()) out += fmt::format("{}: none; {}\n", s.parameter.path, s.refused);
  if (std::any_of(found.values.begin(), found.values.end(), [](double v) { return v < 0; }))
    out += "Changes are shares of |Q| with the sign of dQ: a negative Q grows in size by those below zero.\n";
  return out + fmt::format("{} of CPU time in the steps, with {} parameters followed to both sides\n", seconds_text(found.seconds),
                           std::count_if(found.parameters.begin(), found.parameters.end(), [](const Sensitivity& s) { return s.refused.empty(); }));
}

std::string sensitivity_csv(const Study& study, const Sensitivities& found) {
  const auto text = [](std::string s) {
    std::replace(s.begin(), s.end(), '"', '\'');
    return "\"" + s + "\"";
  };
  std::string out =
      "quantity,value,parameter,parameter_value,derivative,change_per_share,change_per_share_below,change_per_share_above,status,reason\n";
  for (std::size_t q = 0; q < study.quantities.size(); ++q)
    for (const Sensitivity& s : found.parameters) {
      const Derivative& d = s.of[q];
      const bool known = s.refused.empty() && std::isfinite(d.central());
      out += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", text(study.quantities[q].name), csv_cell(found.values[q]), text(s.parameter.path),
                         csv_cell(s.parameter.number()), csv_cell(d.kink ? NAN : d.central() / s.parameter.number()), csv_cell(d.central()),
                         csv_cell(d.below), csv_cell(d.above), !known ? "none" : (d.kink ? "kink" : "done"), text(s.refused));
    }
  return out;
}

}  // namespace mortise::study
