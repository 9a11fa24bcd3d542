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

// The knobs that the error comes from. Of a ladder without a limit whose runs differ by more than the error that was found nothing is known, nor then
// what share the others have.
std::string shares_text(const Results& r, std::size_t k, const std::string& method) {
  const Reference& ref = r.references[k];
  const auto mine = [&](const Share& s) { return s.quantity == k && s.method == method; };
  const auto doubt = [&](const Share& s) { return s.limit.extrapolated ? 0 : s.limit.uncertainty / ref.scale; };
  const auto known = [&](const Share& s) { return doubt(s) <= s.error; };
  double all = 0;
  bool all_known = true;
  for (const Share& s : r.shares)
    if (mine(s)) all += s.error, all_known = all_known && known(s);
  std::string out;
  for (const Share& s : r.shares) {
    if (!mine(s) || !(all > 0)) continue;
    out += (out.empty() ? "" : ", ") + s.ladder + " ";
    if (!known(s))
      out += std::isfinite(doubt(s)) ? fmt::format("up to {} (its runs tell no limit)", error_text(doubt(s), ref)) : "not known";
    else
      out += error_text(s.error, ref) + (all_known ? fmt::format(" ({:.0f} %)", 100 * s.error / all) : "");
  }
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
    if (std::none_of(r.points.begin(), r.points.end(), [&](const Point& p) { return p.quantity == k && p.knee; }))
      out.push_back(fmt::format("{}: no run is known to be better than another; {}", name,
                                std::isfinite(ref.uncertainty) ? "what they are compared with is known to " + error_text(u, ref)
                                                               : "how well what they are compared with is known no run tells"));
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
