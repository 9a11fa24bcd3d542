#include "effects/friction/anchors.h"

#include <utility>

#include "effects/per_environment.h"
#include "linalg/grouping.h"

namespace mortise::effects::friction {

using device::Buffer;
using Vec4 = Eigen::Matrix<double, 4, 1>;

constexpr Index kHeld = model::kSamplePoints / 2;  // points of a sample on one side

Anchors::Anchors(const model::Model& model) : model_(model), deflection_(model.points) {
  deflection_.zero();
  const std::vector<double> area = model.surface.vertex_area.download();
  std::vector<double> cell;
  for (const model::Body& body : model.bodies) {
    double sum = 0;
    Index count = 0;
    for (Index p = body.point_begin; p < body.point_end; ++p) sum += area[p], count += area[p] > 0;
    cell.push_back(count > 0 ? sum / count : 0);
  }
  cell_.upload(cell);
}

void Anchors::keep(const Slips& s, const std::vector<Index>& env_offset, Positions q) {
  const Index samples = s.size();
  const AnchorsView anchors = s.anchors;
  Buffer<std::uint64_t> keys(kHeld * samples);  // the point of every term,
  Buffer<Vec4> terms(kHeld * samples);          // and its weight, behind what that gives
  const View<std::uint64_t> key = keys.view();
  const View<Vec4> term = terms.view();
  device::parallel_for("friction.no_anchors", key.n, [=] MORTISE_HD(Index i) { key[i] = device::kNoKey; });
  device::parallel_for("friction.drag", model_.working(env_offset), [=] MORTISE_HD(Index i) {
    const ContactSample& sample = s.sample[i];
    const double e = s.creep(i), load = s.frozen[i].load;
    const Vec3 u = s.slip(i, q), n = s.frozen[i].normal, before = s.frozen[i].anchor;
    const double x = u.norm(), left = x > e ? e / x : 1;
    const Vec3 change = (anchors.side(sample) / e) * (left * u - before + n.dot(before) * n);
    Index slot = kHeld * i;
    for (Index k = 0; k < sample.points && slot < kHeld * (i + 1); ++k) {
      if (!anchors.holds(sample, k)) continue;
      const double weight = (load < 0 ? -load : load) * (sample.weight[k] < 0 ? -sample.weight[k] : sample.weight[k]);
      if (!(weight > 0)) continue;
      key[slot] = static_cast<std::uint64_t>(sample.point[k]);
      term[slot].head<3>() = weight * change;
      term[slot][3] = weight;
      ++slot;
    }
  });
  linalg::Grouping points;
  linalg::group(std::move(keys), static_cast<std::uint64_t>(model_.points), points);
  Buffer<Vec3> now(model_.points);
  now.zero();
  const View<Vec3> to = now.view(), deflection = deflection_.view();
  const View<const std::uint64_t> point = points.key.view();
  linalg::grouped_sum<Vec4>(
      "friction.anchor", points, [=] MORTISE_HD(Index t) -> Vec4 { return term[t]; },
      [=] MORTISE_HD(Index k, const Vec4& sum) {
        const auto p = static_cast<Index>(point[k]);
        to[p] = deflection[p] + sum.head<3>() / sum[3];
      });
  device::parallel_for("friction.keep", model_.working(model_.env_points), [=] MORTISE_HD(Index p) { deflection[p] = to[p]; });
}

void Anchors::checkpoint(Archive& archive) { io(archive, "anchors", deflection_, model_.env_points); }

}  // namespace mortise::effects::friction
