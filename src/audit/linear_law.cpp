#include "audit/linear_law.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "linalg/small.h"

namespace mortise::audit {

LinearLaw::LinearLaw(const model::ModelInput& input) {
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    const Params* law = in.type == model::BodyType::soft ? in.material.find("model") : nullptr;
    if (law && law->as_text() == "linear") {
      Body b{points_, in.tets, {}, {}};
      for (const Tet& t : in.tets) {
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[t.v[k + 1]] - in.nodes[t.v[0]];
        b.inverse.push_back(edges.inverse()), b.weight.push_back(in.material.number("youngs_modulus") * edges.determinant() / 6);
      }
      bodies_.push_back(std::move(b));
    }
    points_ += in.nodes.size();
  }
}

double LinearLaw::of(std::span<const double> displacement) const {
  if (bodies_.empty() || displacement.size() != 3 * points_) return NAN;
  std::vector<std::pair<double, double>> of_body;  // turned, and with what is strained
  double most = 0;
  for (const Body& b : bodies_) {
    double turned = 0, strained = 0;
    for (std::size_t t = 0; t < b.tets.size(); ++t) {
      const auto u = [&](int k) { return at(displacement, b.first_point + static_cast<std::size_t>(b.tets[t].v[k])); };
      Mat3 edges;
      for (int k = 0; k < 3; ++k) edges.col(k) = u(k + 1) - u(0);
      const Mat3 F = Mat3::Identity() + edges * b.inverse[t];
      const linalg::Svd3 svd = linalg::svd3(F);
      const Mat3 U = svd.V * svd.s.asDiagonal() * svd.V.transpose();
      turned += b.weight[t] * (0.5 * (F + F.transpose()) - U).squaredNorm();
      strained += b.weight[t] * (U - Mat3::Identity()).squaredNorm();
    }
    of_body.emplace_back(turned, turned + strained);
    most = std::max(most, turned + strained);
  }
  double worst = 0;
  for (const auto& [turned, all] : of_body)
    if (all > tuning::kCounts * tuning::kCounts * most) worst = std::max(worst, std::sqrt(turned / all));
  return worst;
}

}  // namespace mortise::audit
