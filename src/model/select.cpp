#include "model/select.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "base/error.h"
#include "geometry/bounds.h"

namespace mortise::model {

std::vector<Index> select(std::span<const Vec3> rest, const Params& where) {
  const geometry::Bounds bounds = geometry::bounds_of(rest);
  const double close = 1e-6 * bounds.size().norm();
  const auto inside = [&](const Vec3& x) {
    if (where.has("side")) {
      const std::string& side = where.text("side");  // "x_min" ... "z_max" or "all"
      if (side == "all") return true;
      const int axis = side[0] - 'x';
      return side.substr(2) == "min" ? x[axis] <= bounds.lo[axis] + close : x[axis] >= bounds.hi[axis] - close;
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

std::vector<Index> select(std::span<const Vec3> rest, const Params* where) {
  if (where) return select(rest, *where);
  std::vector<Index> all(rest.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

namespace {

// How far the nearest of the places is from a box or a sphere [m].
double outside(std::span<const Vec3> rest, const Params& where) {
  double least = INFINITY;
  for (const Vec3& x : rest) {
    if (where.has("box")) {
      const Vec3 lo = where.at("box").vec3("min"), hi = where.at("box").vec3("max");
      least = std::min(least, (x - x.cwiseMax(lo).cwiseMin(hi)).norm());
    } else {
      least = std::min(least, (x - where.at("sphere").vec3("centre")).norm() - where.at("sphere").number("radius"));
    }
  }
  return least;
}

}  // namespace

void selects_nothing(const Params& where, const std::string& what, const std::string& body, std::span<const Vec3> rest) {
  std::ostringstream why;
  if (where.has("box")) {
    const Vec3 a = where.at("box").vec3("min"), b = where.at("box").vec3("max");
    for (int axis = 0; axis < 3; ++axis)
      if (a[axis] > b[axis])
        why << (why.tellp() == 0 ? ": 'min' of its box lies above 'max' along " : ", ") << "xyz"[axis] << " (" << a[axis] << " > " << b[axis] << ")";
  }
  if (why.tellp() == 0 && !where.has("side")) {
    const geometry::Bounds bounds = geometry::bounds_of(rest);
    for (int axis = 0; axis < 3; ++axis)
      why << (axis == 0 ? ": at rest the body lies in " : ", ") << "xyz"[axis] << " = " << bounds.lo[axis] << " to " << bounds.hi[axis] << " m";
    why << ", its nearest node " << outside(rest, where) << " m beside what is asked for";
  }
  throw Error(Exit::scene, where.where(), "selects no " + what + " of body '" + body + "'" + why.str());
}

}  // namespace mortise::model
