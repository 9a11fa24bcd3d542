// One page that opens offline.
#include <fmt/format.h>

#include "study/canvas.h"
#include "study/compare.h"
#include "study/figure.h"
#include "study/report.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.45 'DejaVu Sans',Verdana,sans-serif;max-width:1150px;margin:2em auto;padding:0 1em;color:#111}"
    "h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em}table{border-collapse:collapse;margin:.6em 0;font-size:.88em}"
    "th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #ddd}th:first-child,td:first-child{text-align:left}"
    "tr.best td{background:#eef5fb}tr.knee td{background:#d8eaf8;font-weight:bold}tr.failed td{color:#a33}code{background:#f3f3f3;padding:.1em .3em}"
    "svg{max-width:100%;height:auto}.small{color:#555;font-size:.85em}";

std::string row(const std::vector<std::string>& cells, const char* tag = "td", const char* kind = "") {
  std::string out = *kind ? fmt::format("<tr class=\"{}\">", kind) : "<tr>";
  for (const std::string& c : cells) out += fmt::format("<{0}>{1}</{0}>", tag, escaped(c));
  return out + "</tr>\n";
}

std::string points(const Results& r, std::size_t k) {
  const Reference& ref = r.references[k];
  std::string out = "<table>\n" + row({"run", "curve", "value", "error", "CPU time", "newton", "dofs", "errors that cancel"}, "th");
  for (const Point& p : r.points) {
    if (p.quantity != k) continue;
    if (p.failed)
      out += row({p.label, p.curve, "failed: " + p.why, "", seconds_text(p.seconds), "", "", ""}, "td", "failed");
    else
      out += row({p.label, p.curve, fmt::format("{:.8g}", p.value),
                  p.reference ? "reference" : (p.hollow ? "< " : "") + error_text(p.hollow ? ref.uncertainty / ref.scale : p.error, ref),
                  seconds_text(p.seconds), std::to_string(p.newton), std::to_string(p.dofs), p.cancel},
                 "td",
                 p.knee   ? "knee"
                 : p.best ? "best"
                          : "");
  }
  return out + "</table>\n";
}

std::string same_errors(const Results& r, std::size_t k) {
  const Reference& ref = r.references[k];
  std::vector<std::string> head{"CPU time at an error of"};
  for (double e : tuning::kSameErrors) head.push_back(error_text(e, ref));
  std::string out = "<table>\n" + row(head, "th");
  for (const auto& [name, curve] : curves_of(r.points, k)) {
    if (curve.front()->step == SIZE_MAX) continue;
    std::vector<std::string> cells{name.empty() ? "runs" : name};
    for (double e : tuning::kSameErrors) {
      const double t = e < ref.uncertainty / ref.scale ? NAN : time_at(curve, e);
      cells.push_back(std::isfinite(t) ? seconds_text(t) : "–");
    }
    out += row(cells);
  }
  return out + "</table>\n<p class=\"small\">Between neighbours of a ladder on logarithmic axes, never beyond its ends.</p>\n";
}

}  // namespace

std::string page_html(const Results& r) {
  const std::string of = r.study.benchmark.empty() ? "scene " + r.study.scene : "benchmark " + r.study.benchmark;
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}: accuracy and "
      "time</title><style>{1}</style></head><body>\n<h1>{0}: accuracy and time</h1>\n<p>Of {2}. ",
      escaped(r.study.name), kStyle, escaped(of));
  out +=
      fmt::format("mortise {}, {} ({} cores, load up to {:.1f}), device {}, {} threads; time is that of the steps, in {}, the fastest of {}.</p>\n",
                  escaped(r.version), escaped(r.cpu), r.cores, r.load, escaped(r.device), r.threads,
                  r.device == "cuda" ? "wall seconds" : "CPU seconds (user and system)", r.study.repeats);
  out += figure_svg(r) + "<ul>\n";
  for (const std::string& f : findings(r)) out += "<li>" + escaped(f) + "</li>\n";
  for (const std::string& n : r.notes) out += "<li>" + escaped(n) + "</li>\n";
  out += "</ul>\n";
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    const Reference& ref = r.references[k];
    out += "<h2>" + escaped(r.study.quantities[k].name) + "</h2>\n";
    if (std::isfinite(ref.value))
      out += fmt::format("<p>Compared with {:.8g}{}: {}.</p>\n", ref.value,
                         !std::isfinite(ref.uncertainty) ? ", whose uncertainty is not known"
                         : ref.uncertainty > 0           ? fmt::format(" ± {:.2g}", ref.uncertainty)
                                                         : "",
                         escaped(ref.how));
    out += points(r, k) + same_errors(r, k);
  }
  return out + "</body></html>\n";
}

}  // namespace mortise::study
