#include "audit/slip_onset.h"

#include <algorithm>

#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

// Once for every jump, where it is largest, and only where the body stuck before.
bool SlipOnset::jumped() const {
  const Vec3 from = at(carrier_, 0), to = at(carrier_, 3);
  const double jump = (to - from).norm(), next = (at(carrier_, 4) - at(carrier_, 1)).norm();
  const bool stuck = (at(body_, 0) - from).norm() <= tuning::kStuck * jump;
  return known_ >= kSteps && stuck && jump > before_ && jump >= next && jump > tuning::kSetsIn * std::max(from.norm(), to.norm());
}

Vec3 SlipOnset::offset() const {
  const Vec3 D = at(carrier_, 3) - at(carrier_, 0), B = at(body_, 3) - at(body_, 0);
  Vec3 out = Vec3::Zero();
  for (const int k : {1, 2}) {
    const double s = (at(carrier_, k) - at(carrier_, 0)).dot(D) / D.squaredNorm();
    out += at(body_, k) - at(body_, 0) - std::clamp(s, 0.0, 1.0) * B;
  }
  return out;
}

void SlipOnset::step(const Vec3& carrier, const Vec3& body, const Vec3& slip, double h) {
  Eigen::Map<Vec3> o(offset_), ahead(ahead_);
  before_ = (at(carrier_, 3) - at(carrier_, 0)).norm();
  for (const auto& [list, newest] : {std::pair{carrier_, &carrier}, {body_, &body}}) {
    std::copy(list + 3, list + 3 * kSteps, list);
    Eigen::Map<Vec3>(list + 3 * (kSteps - 1)) = *newest;
  }
  ++known_;
  fastest_ = std::max(fastest_, slip.norm());
  const bool slips = slip.norm() > tuning::kSlips * fastest_;
  if (!slips) o.setZero();
  ahead += h * o;
  if (!jumped()) return;
  const Vec3 now = offset();
  ahead += 3 * h * now;
  if (slips) o += now;
}

}  // namespace mortise::audit
