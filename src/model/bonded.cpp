#include "model/bonded.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/bounds.h"
#include "geometry/collide/distance.h"
#include "model/select.h"

namespace mortise::model {
namespace {

// The surface of a stiff body, at rest.
class Hull {
 public:
  Hull(const BodyInput& body, double reach) : reach_(reach), bounds_(geometry::bounds_of(body.nodes)) {
    for (const Triangle& t : body.triangles) corners_.push_back({body.nodes[t.v[0]], body.nodes[t.v[1]], body.nodes[t.v[2]]});
  }

  bool holds(const Vec3& x) const {
    constexpr double kFourPi = 12.566370614359172, kRounding = 1e-9;
    const double room = reach_ + kRounding * bounds_.size().norm();
    if ((x - bounds_.lo).minCoeff() < -room || (bounds_.hi - x).minCoeff() < -room) return false;
    double turned = 0;  // solid angle of the surface seen from x: 4 pi inside, 0 outside
    for (const std::array<Vec3, 3>& c : corners_) {
      const Vec3 p[4] = {x, c[0], c[1], c[2]};
      if (geometry::closest_point_triangle(p).squared <= room * room) return true;
      const Vec3 a = c[0] - x, b = c[1] - x, d = c[2] - x;
      const double la = a.norm(), lb = b.norm(), ld = d.norm();
      turned += 2 * std::atan2(a.dot(b.cross(d)), la * lb * ld + a.dot(b) * ld + b.dot(d) * la + d.dot(a) * lb);
    }
    return turned > kFourPi / 2;
  }

 private:
  double reach_;
  geometry::Bounds bounds_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace

std::vector<Index> bonded(const Params& bond, const BodyInput& soft, const BodyInput& stiff) {
  if (!bond.has("where") && !bond.has("within")) throw Error(Exit::scene, bond.where(), "which nodes are bonded? give 'where', 'within' or both");
  std::vector<Index> nodes = select(soft.nodes, bond.find("where"));
  if (nodes.empty()) selects_nothing(bond.at("where"), "node", soft.name, soft.nodes);
  if (!bond.has("within")) return nodes;
  const Hull hull(stiff, bond.number("within"));
  std::erase_if(nodes, [&](Index i) { return !hull.holds(soft.nodes[i]); });
  if (nodes.empty())
    throw Error(
        Exit::scene, bond.at("within").where(),
        "no node of '" + soft.name + "'" + (bond.has("where") ? " among them" : "") + " is that near to '" + stiff.name + "' or inside of it");
  return nodes;
}

}  // namespace mortise::model
