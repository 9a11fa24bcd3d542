#include "audit/friction_turned.h"

#include <algorithm>

#include "audit/least_of_last.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

void FrictionTurned::state(const std::vector<Rubbing>& rubs) {
  std::map<Bodies, FrictionPair> now;
  for (const Rubbing& effect : rubs)
    for (const auto& [bodies, rub] : effect) now[bodies].force += rub.force, now[bodies].slips += rub.slips, now[bodies].slid += rub.slid;
  for (auto& [bodies, pair] : pairs_)
    if (!now.count(bodies)) now[bodies] = {};
  for (const auto& [bodies, rub] : now) {
    Pair& pair = pairs_[bodies];
    pair.largest = std::max(pair.largest, rub.force);
    const double force = rub.slips.norm();
    const Vec3 before = at(pair.u, 0), u = force > tuning::kOneSided * rub.slid ? Vec3(rub.slips / force) : Vec3(Vec3::Zero());
    const bool both = before.squaredNorm() > 0 && u.squaredNorm() > 0;
    const double turned = both ? (u - before).norm() / 2 * force / pair.largest : 0, lasts = least_of_last(pair.turned, turned);
    if (both) most_ = std::fmax(most_, lasts);
    std::copy(u.data(), u.data() + 3, pair.u);
  }
}

void FrictionTurned::checkpoint(Archive& archive) {
  std::vector<double> flat;
  for (const auto& [bodies, p] : pairs_) {
    flat.insert(flat.end(), {static_cast<double>(bodies.first), static_cast<double>(bodies.second), p.largest});
    flat.insert(flat.end(), p.u, p.u + 3), flat.insert(flat.end(), p.turned, p.turned + 3);
  }
  archive.io("friction_turned.pairs", flat);
  archive.io("friction_turned.most", most_);
  if (!archive.loading()) return;
  pairs_.clear();
  for (std::size_t i = 0; i + 8 < flat.size(); i += 9) {
    Pair& p = pairs_[{static_cast<std::size_t>(flat[i]), static_cast<std::size_t>(flat[i + 1])}];
    p.largest = flat[i + 2];
    std::copy_n(flat.begin() + static_cast<long>(i) + 3, 3, p.u), std::copy_n(flat.begin() + static_cast<long>(i) + 6, 3, p.turned);
  }
}

}  // namespace mortise::audit
