#pragma once
// Figures, drawn directly as SVG.
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace mortise::bench {

// Measured values in one colour.
struct Dots {
  std::string name;
  std::vector<std::pair<double, double>> points;
};
struct Panel {
  std::string title;
  std::vector<Dots> series;
};

// Panels side by side, two per row, each with its dots over the same exact curve; both axes linear from 0.
std::string profiles_svg(const std::vector<Panel>& panels, const std::function<double(double)>& exact, const std::string& title,
                         const std::string& x_label, const std::string& y_label, double x_end, double y_end);

}  // namespace mortise::bench
