// The figure of a study, drawn directly as SVG.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "study/study.h"

namespace mortise::study {
namespace {

constexpr double kWidth = 760, kHeight = 460, kLeft = 80, kRight = 230, kTop = 40, kBottom = 60;  // legend at the right
constexpr double kLeastError = 1e-16;
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#000000"};  // Okabe and Ito: told apart by everyone

std::string escaped(const std::string& s) {
  std::string out;
  for (char c : s) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return out;
}

// Whole decades that hold the values.
struct Axis {
  int lo = 0, hi = 1;
  double from, to;  // pixels
  Axis(const std::vector<double>& values, double from_pixel, double to_pixel) : from(from_pixel), to(to_pixel) {
    if (values.empty()) return;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    lo = static_cast<int>(std::floor(std::log10(*least))), hi = static_cast<int>(std::ceil(std::log10(*most)));
    if (hi == lo) ++hi;
  }
  double at(double v) const { return from + (to - from) * (std::log10(v) - lo) / (hi - lo); }
};

}  // namespace

std::string figure_svg(const std::vector<Point>& all, const std::string& quantity, const std::string& title) {
  std::vector<Point> points;
  std::vector<std::string> curves;
  std::vector<double> seconds, errors;
  for (const Point& p : all) {
    if (p.quantity != quantity || p.reference) continue;
    points.push_back(p);
    points.back().seconds = std::max(p.seconds, 1e-6);
    seconds.push_back(points.back().seconds);
    if (std::find(curves.begin(), curves.end(), p.curve()) == curves.end()) curves.push_back(p.curve());
    if (p.failed || !std::isfinite(p.error)) continue;
    points.back().error = std::max(p.error, kLeastError);
    errors.push_back(points.back().error);
  }
  const Axis x(seconds, kLeft, kWidth - kRight), y(errors, kHeight - kBottom, kTop);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"13\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{2}\" y=\"24\" font-size=\"15\">{3}</text>\n",
      kWidth, kHeight, kLeft, escaped(title + ": " + quantity));
  const auto line = [&](double x0, double y0, double x1, double y1, const char* colour) {
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x0, y0, x1, y1, colour);
  };
  for (int d = x.lo; d <= x.hi; ++d) {
    const double at = x.at(std::pow(10.0, d));
    line(at, y.from, at, y.to, "#dddddd");
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">1e{}</text>\n", at, y.from + 18, d);
  }
  const int every = std::max(1, (y.hi - y.lo + 7) / 8);
  for (int d = y.lo; d <= y.hi; d += every) {
    const double at = y.at(std::pow(10.0, d));
    line(x.from, at, x.to, at, "#dddddd");
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">1e{}</text>\n", x.from - 6, at + 4, d);
  }
  line(x.from, y.from, x.to, y.from, "black"), line(x.from, y.from, x.from, y.to, "black");
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">seconds</text>\n", 0.5 * (x.from + x.to), kHeight - 16);
  svg +=
      fmt::format("<text x=\"20\" y=\"{0:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 20 {0:.1f})\">error</text>\n", 0.5 * (y.from + y.to));

  // The front: no error smaller than this has been reached within that time.
  std::vector<const Point*> best;
  for (const Point& p : points)
    if (p.best) best.push_back(&p);
  std::sort(best.begin(), best.end(), [](const Point* a, const Point* b) { return a->seconds < b->seconds; });
  std::string steps;
  for (std::size_t i = 0; i < best.size(); ++i) {
    if (i > 0) steps += fmt::format("{:.1f},{:.1f} ", x.at(best[i]->seconds), y.at(best[i - 1]->error));
    steps += fmt::format("{:.1f},{:.1f} ", x.at(best[i]->seconds), y.at(best[i]->error));
  }
  if (!best.empty()) steps += fmt::format("{:.1f},{:.1f} ", x.to, y.at(best.back()->error));  // nothing slower is better
  svg += "<polyline class=\"front\" points=\"" + steps +
         "\" fill=\"none\" stroke=\"#888888\" stroke-width=\"4\" stroke-opacity=\"0.4\" stroke-dasharray=\"6 4\"/>\n";

  for (std::size_t c = 0; c < curves.size(); ++c) {
    const char* colour = kColours[c % std::size(kColours)];
    std::string path, marks;
    for (const Point& p : points) {
      if (p.curve() != curves[c]) continue;
      const double px = x.at(p.seconds);
      if (p.failed || !std::isfinite(p.error)) {
        marks += fmt::format("<path class=\"failed\" d=\"M{0:.1f} {1:.1f}l8 8m0 -8l-8 8\" stroke=\"{2}\" stroke-width=\"2\"/>\n", px - 4, y.to + 4,
                             colour);
        continue;
      }
      path += fmt::format("{:.1f},{:.1f} ", px, y.at(p.error));
      marks += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"><title>{}={}</title></circle>\n", px, y.at(p.error), colour,
                           escaped(p.settings.front().first), escaped(p.settings.front().second));
    }
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"/>\n", path, colour) + marks;
    const double ly = kTop + 16 + 20 * static_cast<double>(c), lx = kWidth - kRight + 16;
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", lx, ly, colour,
                       lx + 10, ly + 4, escaped(curves[c].empty() ? "runs" : curves[c]));
  }
  if (!best.empty()) {
    const double ly = kTop + 16 + 20 * static_cast<double>(curves.size()), lx = kWidth - kRight + 16;
    svg += fmt::format(
        "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#888888\" stroke-width=\"4\" stroke-opacity=\"0.4\" "
        "stroke-dasharray=\"6 4\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\">Pareto front</text>\n",
        lx - 10, ly, lx + 6, ly, lx + 10, ly + 4);
  }
  return svg + "</svg>\n";
}

}  // namespace mortise::study
