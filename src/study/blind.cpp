#include "study/blind.h"

#include <fmt/format.h>

#include <algorithm>

#include "model/held_points.h"
#include "study/tuning.h"

namespace mortise::study {

Blind::Blind(const model::ModelInput& input) {
  const std::vector<bool> held = model::held_points(input);
  std::size_t cell = 0, point = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    if (in.type == model::BodyType::soft) {
      Body b{in.name, cell, {}, {}, in.material.number("poisson_ratio")};
      const auto is_held = [&](Index v) { return held[point + static_cast<std::size_t>(v)]; };
      for (std::size_t t = 0; t < in.tets.size(); ++t) {
        const Index* v = in.tets[t].v;
        Mat3 edges;
        for (int k = 0; k < 3; ++k) edges.col(k) = in.nodes[v[k + 1]] - in.nodes[v[0]];
        b.volume.push_back(edges.determinant() / 6);
        b.held.push_back(std::all_of(v, v + 4, is_held) &&
                         (in.midsides.empty() || std::all_of(std::begin(in.midsides[t].v), std::end(in.midsides[t].v), is_held)));
      }
      bodies_.push_back(std::move(b));
    }
    cell += in.type == model::BodyType::soft ? in.tets.size() : in.triangles.size();
    point += in.nodes.size();
  }
}

void Blind::see(std::span<const double> stress) {
  for (Body& b : bodies_)
    for (std::size_t t = 0; t < b.volume.size(); ++t) {
      const Eigen::Map<const Eigen::Matrix<double, 6, 1>> s(stress.data() + 6 * (b.first_cell + t));
      const double trace = s.head<3>().sum(), square = s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm();
      const double energy = b.volume[t] * ((1 + b.nu) * square - b.nu * trace * trace);
      b.all += energy;
      if (b.held[t]) b.blind += energy;
    }
}

ErrorPart Blind::part(double found) const {
  ErrorPart out{kMeshPart, found, ""};
  if (!soft()) out = {kMeshPart, NAN, "the scene has no soft bodies"};
  double most = tuning::kBlind;
  for (const Body& b : bodies_) {
    const double share = b.blind / b.all;
    if (!(share > most)) continue;
    most = share;
    out.error = NAN;
    out.why_not =
        fmt::format("{:.2g} % of the energy of '{}' is in elements that have no free node, and their stresses tell nothing: use a finer mesh",
                    100 * share, b.name);
  }
  return out;
}

}  // namespace mortise::study
