#include <algorithm>
#include <cmath>

#include "effects/tie.h"
#include "effects/where.h"
#include "geometry/collide/distance.h"

namespace mortise::effects {
namespace {

using param::of;
using param::optional;

const ParamTable kTable = [] {
  ParamTable t{"effect bond",
               "Nodes of soft bodies that move with a stiff body, without matching vertices.",
               {optional(of(Param::Kind::text, "name", Unit::none, std::nullopt, "What its force is called in the output; without it the names of its bodies.")),
                of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of the soft body."),
                of(Param::Kind::text, "to", Unit::none, std::nullopt, "Name of the stiff body that it is bonded to."),
                param::table("where", &where_table, "Nodes of the soft body that are bonded."),
                optional(param::range(of(Param::Kind::number, "within", Unit::length, std::nullopt, "Only nodes inside the stiff body or as near to its surface as this."), 0, INFINITY)),
                of(Param::Kind::flag, "contact", Unit::none, "false", "Whether the two bodies may touch; without it they pass through each other.")}};
  t.is_list = true;
  return t;
}();

// The surface of a stiff body, at rest.
class Hull {
 public:
  Hull(const model::Model& model, Index body, double reach) : reach_(reach) {
    const model::BodyInput* in = nullptr;
    for (const model::BodyInput& b : model.input.bodies)
      if (b.name == model.bodies[body].name && b.env == model.bodies[body].env) in = &b;
    for (const Triangle& t : in->triangles) corners_.push_back({in->nodes[t.v[0]], in->nodes[t.v[1]], in->nodes[t.v[2]]});
    for (const Vec3& x : in->nodes) lo_ = lo_.cwiseMin(x), hi_ = hi_.cwiseMax(x);
  }

  bool holds(const Vec3& x) const {
    constexpr double kFourPi = 12.566370614359172, kRounding = 1e-9;
    const double room = reach_ + kRounding * (hi_ - lo_).norm();
    if ((x - lo_).minCoeff() < -room || (hi_ - x).minCoeff() < -room) return false;
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
  std::vector<std::array<Vec3, 3>> corners_;
  Vec3 lo_ = Vec3::Constant(INFINITY), hi_ = Vec3::Constant(-INFINITY);
};

std::vector<Index> bonded(const Params& p, const model::Model& model, Index soft, Index stiff) {
  const model::Body& body = model.bodies[soft];
  if (body.type != model::BodyType::soft) throw Error(Exit::scene, p.at("body").where(), "'" + body.name + "' is stiff; bonds are of soft bodies (a joint of type fixed ties stiff ones)");
  if (!p.has("where") && !p.has("within")) throw Error(Exit::scene, p.where(), "which nodes are bonded? give 'where', 'within' or both");
  std::vector<Index> points;
  if (p.has("where"))
    points = model::select_points(model, body, p.at("where"));
  else
    for (Index i = body.point_begin; i < body.point_end; ++i) points.push_back(i);
  if (points.empty()) throw Error(Exit::scene, p.at("where").where(), "selects no node of body '" + body.name + "'");
  if (!p.has("within")) return points;
  const std::vector<Vec3> rest = model.rest_points.download();
  const Hull hull(model, stiff, p.number("within"));
  std::erase_if(points, [&](Index i) { return !hull.holds(rest[i]); });
  if (points.empty()) throw Error(Exit::scene, p.at("within").where(), "no node of '" + body.name + "'" + (p.has("where") ? " among them" : "") + " is that near to '" + model.bodies[stiff].name + "' or inside of it");
  return points;
}

// q_n = p + A X: every node follows the material point of the stiff body that is where it is at rest.
std::vector<model::Tie> ties(const Params& list, const model::Model& model) {
  const std::vector<Vec3> rest = model.rest_points.download();
  std::vector<model::Tie> out;
  for (const Params& p : list.items())
    for (const auto& [body, to] : tied_bodies(model, p)) {
      model::Tie tie = tie_of("bond", p, body, to);
      Vec3 mean = Vec3::Zero();
      for (Index point : bonded(p, model, body, to)) {
        model::Follow f = material_point(model, to, rest[point]);
        f.block = model.bodies[body].block_begin + (point - model.bodies[body].point_begin);
        tie.follows.push_back(std::move(f));
        mean += rest[point];
      }
      tie.anchor = material_point(model, to, mean / static_cast<double>(tie.follows.size()));
      out.push_back(std::move(tie));
    }
  return out;
}

}  // namespace

const Kind& bond_kind() {
  static const Kind kind{"bond", Role::tie, "soft bodies are bonded to stiff ones", &kTable,
          [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<TieEffect>("bond", m, ties(p, m)); }, {}, {"bond_force"}};
  return kind;
}

}  // namespace mortise::effects
