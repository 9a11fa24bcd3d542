#include "model/select.h"

namespace mortise::model {

std::vector<Index> select(std::span<const Vec3> rest, const Params& where) {
  Vec3 lo = Vec3::Constant(INFINITY), hi = -lo;
  for (const Vec3& x : rest) lo = lo.cwiseMin(x), hi = hi.cwiseMax(x);
  const double close = 1e-6 * (hi - lo).norm();
  const auto inside = [&](const Vec3& x) {
    if (where.has("side")) {
      const std::string& side = where.text("side");  // "x_min" ... "z_max" or "all"
      if (side == "all") return true;
      const int axis = side[0] - 'x';
      return side.substr(2) == "min" ? x[axis] <= lo[axis] + close : x[axis] >= hi[axis] - close;
    }
    if (where.has("box")) {
      const Params& box = where.at("box");
      const Vec3 a = box.vec3("min"), b = box.vec3("max");
      return (x.array() >= a.array()).all() && (x.array() <= b.array()).all();
    }
    const Params& sphere = where.at("sphere");
    return (x - sphere.vec3("centre")).norm() <= sphere.number("radius");
  };
  std::vector<Index> out;
  for (std::size_t i = 0; i < rest.size(); ++i)
    if (inside(rest[i])) out.push_back(static_cast<Index>(i));
  return out;
}

}  // namespace mortise::model
