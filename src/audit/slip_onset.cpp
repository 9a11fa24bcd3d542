#include "audit/slip_onset.h"

#include <algorithm>

#include "audit/tuning.h"

namespace mortise::audit {

namespace {

Vec3 entry(const double* list, int k) { return {list[3 * k], list[3 * k + 1], list[3 * k + 2]}; }

void append(double* list, int count, const Vec3& value) {
  std::copy(list + 3, list + 3 * count, list);
  Eigen::Map<Vec3>(list + 3 * (count - 1)) = value;
}

}  // namespace

// Once for every jump, where it is largest, and only where the body stuck before.
bool SlipOnset::jumped() const {
  const Vec3 from = entry(carrier_, 0), to = entry(carrier_, 3);
  const double jump = (to - from).norm(), next = (entry(carrier_, 4) - entry(carrier_, 1)).norm();
  const bool stuck = (entry(body_, 0) - from).norm() <= tuning::kStuck * jump;
  return known_ >= kSteps && stuck && jump > before_ && jump >= next && jump > tuning::kSetsIn * std::max(from.norm(), to.norm());
}

Vec3 SlipOnset::offset() const {
  const Vec3 D = entry(carrier_, 3) - entry(carrier_, 0), B = entry(body_, 3) - entry(body_, 0);
  Vec3 out = Vec3::Zero();
  for (const int k : {1, 2}) {
    const double s = (entry(carrier_, k) - entry(carrier_, 0)).dot(D) / D.squaredNorm();
    out += entry(body_, k) - entry(body_, 0) - std::clamp(s, 0.0, 1.0) * B;
  }
  return out;
}

void SlipOnset::step(const Vec3& carrier, const Vec3& body, const Vec3& slip, double h) {
  Eigen::Map<Vec3> o(offset_), ahead(ahead_);
  const double last = (entry(carrier_, 3) - entry(carrier_, 0)).norm();
  append(carrier_, kSteps, carrier), append(body_, kSteps, body), ++known_;
  before_ = last;
  fastest_ = std::max(fastest_, slip.norm());
  if (slip.norm() <= tuning::kSlips * fastest_) o.setZero();
  ahead += h * o;
  if (!jumped()) return;
  const Vec3 now = offset();
  ahead += 3 * h * now;
  if (slip.norm() > tuning::kSlips * fastest_) o += now;
}

}  // namespace mortise::audit
