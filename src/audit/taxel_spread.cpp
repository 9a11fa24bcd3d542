#include "audit/taxel_spread.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "sensors/sensors.h"

namespace mortise::audit {

TaxelSpread::TaxelSpread(const model::ModelInput& input) {
  for (const sensors::Sensor& s : sensors::Sensors(input).all()) {
    std::size_t first = 0;
    for (const model::BodyInput& body : input.bodies) {
      if (body.name == s.body() && body.type != model::BodyType::soft) {
        std::vector<Node>& grid = grids_.emplace_back();
        const std::vector<double> square = sensors::squares(body, s.spec());
        for (std::size_t n = 0; n < square.size(); ++n)
          if (square[n] > 0) grid.push_back({first + n, std::min(1.0, tuning::kSpread * square[n] / s.spec().taxel_area())});
      }
      first += body.nodes.size();
    }
  }
}

double TaxelSpread::of(std::span<const double> contact_force) const {
  double worst = NAN;
  for (const std::vector<Node>& grid : grids_) {
    double wrong = 0, all = 0;
    for (const Node& n : grid) {
      if (contact_force.size() < 3 * (n.point + 1)) continue;
      const double force = at(contact_force, n.point).norm();
      wrong += n.share * force, all += force;
    }
    if (all > 0) worst = std::fmax(worst, wrong / all);
  }
  return worst;
}

}  // namespace mortise::audit
