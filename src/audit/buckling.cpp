#include "audit/buckling.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "audit/moving_body.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/topology.h"

namespace mortise::audit {

Buckling::Buckling(const model::ModelInput& input) : step_(integration_of(input.scene).step) {
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    const std::size_t own = first;
    first += body.nodes.size();
    if (body.type != model::BodyType::soft) continue;
    const geometry::MassProperties m = geometry::mass_properties({body.nodes, body.triangles});
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(m.second_moment / m.volume);
    const double gyration = std::sqrt(axes.eigenvalues()[0]), length = std::sqrt(12 * axes.eigenvalues()[2]);
    const double box = length * 12 * gyration * std::sqrt(axes.eigenvalues()[1]);  // volume of a box with these radii of gyration
    if (!(length > tuning::kSlender * std::sqrt(12) * gyration) || m.volume < tuning::kFull * box) continue;
    Bar bar{own, {}, body.nodes, gyration, std::sqrt(body.material.number("youngs_modulus") / body.material.number("density"))};
    for (const Vec3& x : body.nodes) bar.along.push_back((x - m.centroid).dot(axes.eigenvectors().col(2)));
    bars_.push_back(std::move(bar));
  }
}

Buckling::Span Buckling::free_span(const Bar& bar, const Snapshot& said) {
  std::vector<double> held;
  for (const char* force : {"support_force", "tie_force", "contact_force"})
    if (const Snapshot::Values* f = said.of_points(force, 3))
      for (std::size_t i = 0; i < bar.along.size(); ++i)
        if (at(*f, bar.first + i) != Vec3::Zero()) held.push_back(bar.along[i]);
  if (held.empty()) return {0, 0, false};
  std::sort(held.begin(), held.end());
  const auto [low, high] = std::minmax_element(bar.along.begin(), bar.along.end());
  Span longest{*low, held.front(), false};
  // A free end counts as twice its length, by what it bears.
  const auto effective = [](const Span& s) { return (s.held ? 1 : 4) * s.length(); };
  const auto take = [&](const Span& s) {
    if (effective(s) > effective(longest)) longest = s;
  };
  take({held.back(), *high, false});
  for (std::size_t i = 1; i < held.size(); ++i) take({held[i - 1], held[i], true});
  return longest;
}

// By how much the line through the middles of slices of the span is shorter than at rest, over that.
double Buckling::shortened(const Bar& bar, const Span& span, const std::vector<double>& points) {
  constexpr int kSlices = 8;
  Vec3 rest[kSlices], now[kSlices];
  int count[kSlices] = {};
  std::fill_n(rest, kSlices, Vec3::Zero()), std::fill_n(now, kSlices, Vec3::Zero());
  for (std::size_t i = 0; i < bar.along.size(); ++i) {
    const int k = static_cast<int>(std::floor((bar.along[i] - span.from) / span.length() * kSlices));
    if (k < 0 || k >= kSlices) continue;
    rest[k] += bar.rest[i], now[k] += at(points, bar.first + i), ++count[k];
  }
  double before = 0, after = 0;
  for (int k = 0, last = -1; k < kSlices; ++k) {
    if (count[k] == 0) continue;
    if (last >= 0) before += (rest[k] / count[k] - rest[last] / count[last]).norm(), after += (now[k] / count[k] - now[last] / count[last]).norm();
    last = k;
  }
  return before > 0 ? 1 - after / before : 0;
}

void Buckling::state(const Snapshot& said, const std::vector<double>& points) {
  for (Bar& bar : bars_) {
    const Span span = free_span(bar, said);
    const double L = span.length(), critical = (span.held ? 4 : 0.25) * std::pow(std::numbers::pi * bar.gyration / L, 2);
    const bool slender = L > tuning::kSlender * std::sqrt(12) * bar.gyration * (span.held ? 1 : 0.5);
    const double beyond = slender ? shortened(bar, span, points) / critical - 1 : -1;
    if (std::isnan(step_)) {
      bar.beyond = beyond;
      continue;
    }
    // omega = 22.4 i c / L^2 of a bar that is held at both ends, 3.52 of one that is held at one.
    const double period = 2 * std::numbers::pi * L * L / ((span.held ? 22.4 : 3.52) * bar.gyration * bar.speed);
    bar.beyond += (beyond - bar.beyond) * step_ / (period + step_);
  }
}

double Buckling::value() const {
  double most = NAN;
  for (const Bar& bar : bars_) most = std::fmax(most, std::max(bar.beyond, 0.0));
  return most;
}

void Buckling::checkpoint(Archive& archive) {
  std::vector<double> beyond;
  for (const Bar& bar : bars_) beyond.push_back(bar.beyond);
  archive.io("buckling.beyond", beyond);
  for (std::size_t i = 0; i < std::min(beyond.size(), bars_.size()); ++i) bars_[i].beyond = beyond[i];
}

}  // namespace mortise::audit
