// The tables of the terminal.
#include <fmt/format.h>

#include <algorithm>

#include "study/compare.h"
#include "study/report.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

std::string points_table(const Results& r, std::size_t k) {
  const Reference& ref = r.references[k];
  std::size_t wide = 20;
  for (const Point& p : r.points) wide = std::max(wide, std::min<std::size_t>(p.label.size(), 70));
  std::string out = fmt::format("  {:{}} {:>13} {:>11} {:>11} {:>8} {:>7}\n", "run", wide, "value", "error", "CPU time", "newton", "dofs");
  for (const auto& [curve, points] : curves_of(r.points, k)) {
    if (!curve.empty() && points.front()->step != SIZE_MAX) out += " " + curve + "\n";
    for (const Point* p : points) {
      if (p->failed) {
        out += fmt::format("  {:{}} failed: {}\n", p->label, wide, p->why);
        continue;
      }
      std::string mark = p->knee ? " * knee" : p->best ? " *" : "";
      if (!p->cancel.empty()) mark += "  (" + p->cancel + " cancel)";
      out += fmt::format("  {:{}} {:>13.6g} {:>11} {:>11} {:>8} {:>7}{}\n", p->label, wide, p->value,
                         p->reference ? "reference" : (p->hollow ? "<" : "") + error_text(p->hollow ? ref.uncertainty / ref.scale : p->error, ref),
                         seconds_text(p->seconds), p->newton, p->dofs, mark);
    }
  }
  return out;
}

std::string same_error_table(const Results& r, std::size_t k) {
  const auto curves = curves_of(r.points, k);
  const Reference& ref = r.references[k];
  std::vector<double> levels;
  for (double e : tuning::kSameErrors)
    if (!(e < ref.uncertainty / ref.scale) &&
        std::count_if(curves.begin(), curves.end(), [&](const auto& c) { return std::isfinite(time_at(c.second, e)); }) > 1)
      levels.push_back(e);
  if (curves.size() < 2) return "";
  if (levels.empty()) return "  no two curves have an accuracy in common: their times do not compare\n";
  std::size_t wide = 20;
  for (const auto& [name, points] : curves) wide = std::max(wide, name.size());
  std::string out = fmt::format("  {:{}}", "CPU time at an error of", wide);
  for (double e : levels) out += fmt::format(" {:>10}", error_text(e, ref));
  out += "\n";
  for (const auto& [name, points] : curves) {
    if (points.front()->step == SIZE_MAX) continue;
    out += fmt::format("  {:{}}", name, wide);
    for (double e : levels) {
      const double t = time_at(points, e);
      out += fmt::format(" {:>10}", std::isfinite(t) ? seconds_text(t) : "-");
    }
    out += "\n";
  }
  return out + "  (between neighbours of a ladder, never beyond its ends)\n";
}

}  // namespace

std::string text_report(const Results& r) {
  std::string out;
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    const Reference& ref = r.references[k];
    out += "\n" + r.study.quantities[k].name + "\n";
    if (std::isfinite(ref.value))
      out += fmt::format("  compared with {:.8g}{} ({})\n", ref.value,
                         !std::isfinite(ref.uncertainty) ? ", uncertainty not known"
                         : ref.uncertainty > 0           ? fmt::format(" +- {:.2g}", ref.uncertainty)
                                                         : "",
                         ref.how);
    out += points_table(r, k) + same_error_table(r, k);
  }
  out += "\n";
  for (const std::string& f : findings(r)) out += f + "\n";
  for (const std::string& n : r.notes) out += n + "\n";
  out += fmt::format(
      "\ntime: {} of the steps on {} ({} cores, load up to {:.1f}, {} threads){}; mortise {}\n* nothing faster is as accurate; <: the reference is "
      "known no "
      "better\n",
      r.device == "cuda" ? "wall seconds" : "CPU seconds", r.cpu, r.cores, r.load, r.threads,
      r.load > r.cores ? "; the machine was overloaded, which makes CPU seconds longer too" : "", r.version);
  return out;
}

}  // namespace mortise::study
