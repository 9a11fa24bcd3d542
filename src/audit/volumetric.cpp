#include "audit/volumetric.h"

#include <fmt/format.h>

#include <algorithm>

#include "audit/tuning.h"
#include "model/clusters.h"
#include "model/volumetric.h"

namespace mortise::audit {

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
    const Params* key = b.material.find("volumetric");
    const double nu = b.material.number("poisson_ratio"), above = b.midsides.empty() ? model::kAveragedAbove : tuning::kQuadraticLocks;
    if (!(key && key->as_text() == "full" && nu > above)) continue;
    out.push_back(fmt::format("{}{}volumetric: full at Poisson's ratio {:g}: the elements of body '{}' lock and its deformations come out too small",
                              key->where().file.empty() ? "" : key->where().text(), key->where().file.empty() ? "" : ": ", nu, b.name));
  }
  return out;
}

}  // namespace mortise::audit
