#include "run/volumetric.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/clusters.h"
#include "model/volumetric.h"
#include "run/tuning.h"

namespace mortise::run {

std::string volumetric(const model::BodyInput& body) {
  const bool quadratic = !body.midsides.empty();
  if (!model::averages_volume(body.material)) return "full";
  if (quadratic) return "averaged over every element";
  const std::vector<Index> cluster = model::star_clusters(body);
  return fmt::format("averaged over {} clusters", 1 + *std::max_element(cluster.begin(), cluster.end()));
}

std::vector<std::string> locking_risks(const model::ModelInput& input) {
  std::vector<std::string> out;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type != model::BodyType::soft) continue;
    const double above = b.midsides.empty() ? model::kAveragedAbove : tuning::kQuadraticLocks;
    if (!(b.material.number("poisson_ratio") > above) || model::averages_volume(b.material)) continue;
    const Params& key = b.material.at("volumetric");
    out.push_back(fmt::format("{}{}volumetric: full at Poisson's ratio {:g}: the elements of body '{}' lock and its deformations come out too small",
                              key.where().file.empty() ? "" : key.where().text(), key.where().file.empty() ? "" : ": ",
                              b.material.number("poisson_ratio"), b.name));
  }
  return out;
}

}  // namespace mortise::run
