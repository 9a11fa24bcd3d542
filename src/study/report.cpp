#include "study/report.h"

#include <fmt/format.h>

#include <algorithm>

#include "output/atomic_file.h"
#include "study/figure.h"
#include "study/variant.h"

namespace mortise::study {

std::string recommended_yaml(const Results& r) {
  const auto knee = std::find_if(r.points.begin(), r.points.end(), [](const Point& p) { return p.quantity == 0 && p.knee; });
  if (!r.study.benchmark.empty() || knee == r.points.end()) return "";
  const Reference& ref = r.references[0];
  std::string out = fmt::format("# {}, with the settings where the front of a study of '{}' bends:\n", r.study.scene, r.study.quantities[0].name);
  const Method& method = r.study.methods[knee->method];
  for (const std::string& set : method.set) out += "#   " + set + "\n";
  for (const auto& [path, value] : knee->settings) out += fmt::format("#   {}={}\n", path, value);
  if (knee->settings.empty() && method.set.empty()) out += "#   those that it has\n";
  out += fmt::format("# Error {} in {} of CPU time, compared with {:.8g} ({}).\n",
                     error_text(std::max(knee->error, knee->hollow ? ref.uncertainty / ref.scale : 0.0), ref), seconds_text(knee->seconds), ref.value,
                     ref.how);
  return out + variant_of(r.study, method, knee->settings, true).yaml;
}

void write_reports(const Results& r, const std::string& folder) {
  const auto write = [&](const char* name, const std::string& text) { output::write_file_atomically(folder + "/" + name, text, false); };
  write("points.csv", points_csv(r));
  write("work_precision.svg", figure_svg(r));
  write_figure_png(r, folder + "/work_precision.png");
  write("study.html", page_html(r));
  if (const std::string scene = recommended_yaml(r); !scene.empty()) write("recommended.yaml", scene);
  write("study.json", study_json(r));  // last: what is in it is there
}

}  // namespace mortise::study
