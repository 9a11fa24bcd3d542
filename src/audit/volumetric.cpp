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

std::vector<std::string> single_elements(const model::ModelInput& input) {
  std::vector<std::string> out;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type != model::BodyType::soft || b.midsides.empty() || !(b.material.number("poisson_ratio") > model::kAveragedAbove)) continue;
    const Params* key = b.material.find("volumetric");
    if (!model::averages_volume(b) && !(key && key->as_text() == "full"))
      out.push_back(
          fmt::format("body '{}' has one quadratic element across, at Poisson's ratio {:g}: it may be a quarter too stiff, and twice as stiff as it "
                      "should be where elements are several times as long as it is thick; with two elements across it is right to a few percent",
                      b.name, b.material.number("poisson_ratio")));
  }
  return out;
}

std::vector<std::string> locking_risks(const model::ModelInput& input) {
  std::vector<std::string> out = single_elements(input);
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
