#include "effects/contact/nodal_pressure.h"

#include <algorithm>
#include <utility>

#include "effects/contact/tuning.h"

namespace mortise::effects::contact {

NodalPressure nodal_pressure(const geometry::Surface& surface, const std::vector<Vec3>& y, const std::vector<double>& f,
                             const std::vector<double>& covered) {
  std::vector<double> size(y.size()), best(y.size(), 0.0), area(y.size(), 0.0);
  const auto force = [&](std::size_t i) { return Eigen::Map<const Vec3>(f.data() + 3 * i); };
  for (std::size_t i = 0; i < y.size(); ++i) size[i] = force(i).norm();
  const auto triangles = surface.triangles.download();
  const auto for_each_corner = [&](const auto& visit) {  // with n and |T|
    for (const Triangle& t : triangles) {
      if (size[t.v[0]] == 0 && size[t.v[1]] == 0 && size[t.v[2]] == 0) continue;
      const Vec3 twice = (y[t.v[1]] - y[t.v[0]]).cross(y[t.v[2]] - y[t.v[0]]);
      const double length = twice.norm();
      for (Index i : t.v)
        if (size[i] > 0 && length > 0) visit(i, -twice.dot(force(i)) / (length * size[i]), length / 2);
    }
  };
  for_each_corner([&](Index i, double faces, double) { best[i] = std::max(best[i], faces); });
  for_each_corner([&](Index i, double faces, double a) {
    if (faces > tuning::kFaces * best[i]) area[i] += faces * a / 3;
  });
  std::vector<double> p(y.size(), 0.0);
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!covered.empty() && covered[i] > 0) area[i] = std::min(covered[i], area[i]);
    if (area[i] > 0) p[i] = size[i] / area[i];
  }
  return {std::move(p), std::move(area)};
}

}  // namespace mortise::effects::contact
