#include "bench/hertz/profiles.h"

#include <fmt/format.h>

#include <algorithm>

namespace mortise::bench {
namespace {

constexpr double kWidth = 400, kHeight = 280, kLeft = 56, kRight = 12, kTop = 34, kBottom = 46, kHead = 30;  // of a panel; above them all
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7"};
constexpr double kRadius[] = {3.4, 2.6, 2.2, 1.8};  // later series lie on earlier ones

}  // namespace

std::string profiles_svg(const std::vector<Panel>& panels, const std::function<double(double)>& exact, const std::string& title,
                         const std::string& x_label, const std::string& y_label, double x_end, double y_end) {
  const std::size_t columns = panels.size() > 1 ? 2 : 1, rows = (panels.size() + columns - 1) / columns;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n<text x=\"{2}\" y=\"20\" font-size=\"15\">{3}</text>\n",
      columns * kWidth, rows * kHeight + kHead, kLeft, title);
  for (std::size_t i = 0; i < panels.size(); ++i) {
    const double left = static_cast<double>(i % columns) * kWidth + kLeft, top = static_cast<double>(i / columns) * kHeight + kHead + kTop;
    const double right = left - kLeft + kWidth - kRight, bottom = top - kTop + kHeight - kBottom;
    const auto x = [&](double v) { return left + (right - left) * v / x_end; };
    const auto y = [&](double v) { return bottom + (top - bottom) * std::clamp(v, 0.0, y_end) / y_end; };
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"13\" font-weight=\"bold\">{}</text>\n", left, top - 10, panels[i].title);
    for (int k = 0; 0.2 * k <= std::max(x_end, y_end) + 1e-9; ++k) {
      const double v = 0.2 * k;
      if (v <= x_end + 1e-9)
        svg += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\" stroke=\"#e4e4e4\"/><text x=\"{0:.1f}\" y=\"{3:.1f}\" "
            "text-anchor=\"middle\">{4:.1f}</text>\n",
            x(v), top, bottom, bottom + 16, v);
      if (v <= y_end + 1e-9)
        svg += fmt::format(
            "<line x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#e4e4e4\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
            "text-anchor=\"end\">{5:.1f}</text>\n",
            left, right, y(v), left - 6, y(v) + 4, v);
    }
    for (std::size_t k = 0; k < panels[i].series.size(); ++k) {
      const Dots& dots = panels[i].series[k];
      const std::size_t look = std::min(k, std::size(kColours) - 1);
      svg += fmt::format("<g fill=\"{}\" fill-opacity=\"0.75\">", kColours[look]);
      for (const auto& [r, p] : dots.points)
        if (r <= x_end) svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\"/>", x(r), y(p), kRadius[look]);
      const double at = top + 14 + 16 * static_cast<double>(k);
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"/></g>\n<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", right - 70, at, right - 62,
                         at + 4, dots.name);
    }
    std::string curve;
    constexpr int kSteps = 400;
    for (int k = 0; k <= kSteps; ++k) curve += fmt::format("{:.1f},{:.1f} ", x(x_end * k / kSteps), y(exact(x_end * k / kSteps)));
    svg += fmt::format("<polyline class=\"exact\" points=\"{}\" fill=\"none\" stroke=\"black\" stroke-width=\"1.6\"/>\n", curve);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", 0.5 * (left + right), bottom + 34, x_label);
    svg += fmt::format("<text x=\"{0:.1f}\" y=\"{1:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 {0:.1f} {1:.1f})\">{2}</text>\n", left - 40,
                       0.5 * (top + bottom), y_label);
  }
  return svg + "</svg>\n";
}

}  // namespace mortise::bench
