#include "effects/contact/start_gap.h"

#include <algorithm>

#include "effects/roles.h"
#include "geometry/bounds.h"
#include "geometry/nearest_triangle.h"

namespace mortise::effects::contact {
namespace {

bool names(const Params& list, const std::string& body) {
  if (list.kind() == Params::Kind::text) return list.as_text() == body;
  const std::vector<Params>& items = list.items();
  return std::any_of(items.begin(), items.end(), [&](const Params& name) { return names(name, body); });
}

// {master, slave}, [a, b] or {bodies: [a, b, ...]}.
bool is_of(const Params& pair, const std::string& a, const std::string& b) {
  if (pair.kind() != Params::Kind::table) return names(pair, a) && names(pair, b);
  if (pair.has("bodies")) return names(pair.at("bodies"), a) && names(pair.at("bodies"), b);
  const std::string &slave = pair.text("slave"), &master = pair.text("master");
  return (slave == a && master == b) || (slave == b && master == a);
}

class Meeting {
 public:
  Meeting(const Params& effect, const Params& scene) : own_(effect.find("pairs")), all_(scene.find("pairs")) {
    const Params& effects = scene.at("effects");
    effects_ = &effects;
    for (const std::string& tie : of_role(effects, Role::tie))
      for (const Params& p : effects.at(tie).items()) ties_.push_back(&p);
  }
  bool operator()(const std::string& a, const std::string& b) const {
    if (held(a) && held(b)) return false;
    const auto of_both = [&](const Params& pair) { return is_of(pair, a, b); };
    if (own_ && std::none_of(own_->items().begin(), own_->items().end(), of_both)) return false;
    if (all_ && all_->kind() == Params::Kind::list &&
        std::any_of(all_->items().begin(), all_->items().end(), [&](const Params& pair) { return !pair.flag("collide") && of_both(pair); }))
      return false;
    return std::none_of(ties_.begin(), ties_.end(), [&](const Params* tie) {
      const std::string& body = tie->text("body");
      return tie->has("to") && ((body == a && tie->text("to") == b) || (body == b && tie->text("to") == a));
    });
  }

 private:
  // Is all of it pinned?
  bool held(const std::string& body) const {
    const std::vector<const Params*> pins = of_body(*effects_, Role::support, body);
    return std::any_of(pins.begin(), pins.end(), [](const Params* pin) {
      const Params* where = pin->find("where");
      return where && where->has("side") && where->text("side") == "all";
    });
  }

  const Params *own_, *all_, *effects_;
  std::vector<const Params*> ties_;
};

// Of the vertices of `a` to the surface of `b`, both only where the other is nearer than `upto`.
double vertices_to_surface(const model::BodyInput& a, const model::BodyInput& b, double upto) {
  geometry::Bounds near = geometry::bounds_of(b.nodes);
  near.lo.array() -= upto, near.hi.array() += upto;
  std::vector<Vec3> vertices;
  geometry::Bounds there;
  for (const Vec3& x : a.nodes)
    if ((x.array() >= near.lo.array()).all() && (x.array() <= near.hi.array()).all()) vertices.push_back(x), there.include(x);
  if (vertices.empty()) return upto;
  there.lo.array() -= upto, there.hi.array() += upto;
  std::vector<Triangle> triangles;
  for (const Triangle& t : b.triangles) {
    geometry::Bounds box;
    for (const Index v : t.v) box.include(b.nodes[v]);
    if ((box.hi.array() >= there.lo.array()).all() && (box.lo.array() <= there.hi.array()).all()) triangles.push_back(t);
  }
  if (triangles.empty()) return upto;
  const geometry::NearestTriangle surface(b.nodes, triangles);
  double least = upto;
  for (const Vec3& x : vertices) least = std::min(least, surface.distance(x));
  return least;
}

}  // namespace

double start_gap(const Params& effect, const model::ModelInput& input, const std::vector<const model::BodyInput*>& bodies, Index env, double upto) {
  const Meeting meet(effect, input.scene);
  double least = upto;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const model::BodyInput& a = *bodies[i];
    for (std::size_t j = i + 1; j < bodies.size(); ++j)
      if (const model::BodyInput& b = *bodies[j]; meet(a.name, b.name))
        least = std::min({least, vertices_to_surface(a, b, upto), vertices_to_surface(b, a, upto)});
    for (const model::BodyInput& plane : input.bodies) {
      if (plane.type != model::BodyType::half_space || plane.env != env || !meet(a.name, plane.name)) continue;
      const Vec3 n = plane.params.vec3("normal").normalized(), o = plane.params.vec3("point");
      for (const Vec3& x : a.nodes) least = std::min(least, std::abs((x - o).dot(n)));
    }
  }
  return least;
}

}  // namespace mortise::effects::contact
