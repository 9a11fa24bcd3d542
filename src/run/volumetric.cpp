#include "run/volumetric.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/clusters.h"
#include "model/volumetric.h"
#include "run/tuning.h"

namespace mortise::run {

std::string volumetric(const model::BodyInput& body) {
  const bool quadratic = !body.midsides.empty();
  if (!model::averages_volume(body)) return "full";
  if (quadratic) return "averaged over every element";
  const std::vector<Index> cluster = model::star_clusters(body);
  return fmt::format("averaged over {} clusters", 1 + *std::max_element(cluster.begin(), cluster.end()));
}

std::vector<std::string> locking_risks(const model::ModelInput& input) {
  std::vector<std::string> out;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type != model::BodyType::soft) continue;
    const double nu = b.material.number("poisson_ratio");
    const bool quadratic = !b.midsides.empty();
    if (model::averages_volume(b) || !(nu > model::kAveragedAbove)) continue;
    if (const Params* key = b.material.find("volumetric"); key && key->as_text() == "full") {
      if (!(nu > (quadratic ? tuning::kQuadraticLocks : model::kAveragedAbove))) continue;
      out.push_back(
          fmt::format("{}{}volumetric: full at Poisson's ratio {:g}: the elements of body '{}' lock and its deformations come out too small",
                      key->where().file.empty() ? "" : key->where().text(), key->where().file.empty() ? "" : ": ", nu, b.name));
    } else {
      out.push_back(
          fmt::format("body '{}' has one quadratic element across, at Poisson's ratio {:g}: it may be a quarter too stiff; half the edge length is "
                      "right to a few percent",
                      b.name, nu));
    }
  }
  return out;
}

}  // namespace mortise::run
