// What a study says in sentences.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/compare.h"
#include "study/report.h"

namespace mortise::study {

std::string error_text(double e, const Reference& ref) {
  if (!std::isfinite(e)) return "not known";
  if (!ref.relative) return fmt::format("{:.3g}", e);
  return e >= 1e-4 || e == 0 ? fmt::format("{:.3g} %", 100 * e) : fmt::format("{:.2g}", e);
}

std::string seconds_text(double s) { return std::isfinite(s) ? fmt::format("{:.3g} s", s) : "-"; }

namespace {

// The knobs that the error comes from.
std::string shares_text(const Results& r, std::size_t k, const std::string& method) {
  const auto mine = [&](const Share& s) { return s.quantity == k && s.method == method; };
  double all = 0;
  for (const Share& s : r.shares)
    if (mine(s)) all += s.error;
  std::string out;
  for (const Share& s : r.shares)
    if (mine(s) && all > 0)
      out += fmt::format("{}{} {} ({:.0f} %)", out.empty() ? "" : ", ", s.ladder, error_text(s.error, r.references[k]), 100 * s.error / all);
  return out;
}

}  // namespace

std::vector<std::string> findings(const Results& r) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    const Reference& ref = r.references[k];
    const std::string& name = r.study.quantities[k].name;
    const double u = std::isfinite(ref.uncertainty) ? ref.uncertainty / ref.scale : 0;
    const auto of = [&](const Point& p) {
      const std::string cancel = p.cancel.empty() ? "" : fmt::format(" (errors of {} cancel: that the value is near is luck)", p.cancel);
      return fmt::format("{:.6g}, {} {}{} in {}", p.value, p.hollow ? "error below" : "error", error_text(p.hollow ? u : p.error, ref), cancel,
                         seconds_text(p.seconds));
    };
    for (const Point& p : r.points)
      if (p.quantity == k && p.step == SIZE_MAX && p.failed)
        out.push_back(fmt::format("{}, {}: failed, {}", name, p.label, p.why));
      else if (p.quantity == k && p.step == SIZE_MAX)
        out.push_back(fmt::format("{}, {}: {}", name, p.label, of(p)));
    for (const Method& m : r.study.methods)
      if (const std::string parts = shares_text(r, k, m.name); !parts.empty())
        out.push_back(fmt::format("{}{}{}, where the error as it is comes from: {}", name, m.name.empty() ? "" : ", ", m.name, parts));
    for (const Point& p : r.points) {
      if (p.quantity != k || !p.knee) continue;
      std::string text = fmt::format("{}, at the knee ({}): {}", name, p.label.empty() ? p.curve : p.label, of(p));
      const double half = 0.5 * std::max(p.error, u), cost = half > u ? front_time_at(r.points, k, half) : NAN;
      if (half <= u)
        text += "; half of it is below what the reference is known to";
      else if (std::isfinite(cost))
        text += fmt::format("; half the error takes {}, {:.2g} times as long", seconds_text(cost), cost / p.seconds);
      else
        text += "; no run of this study has half the error";
      out.push_back(text);
    }
  }
  return out;
}

}  // namespace mortise::study
