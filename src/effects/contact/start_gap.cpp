#include "effects/contact/start_gap.h"

#include <algorithm>
#include <set>
#include <string>

#include "effects/contact/named.h"
#include "effects/roles.h"
#include "geometry/bounds.h"
#include "geometry/nearest_triangle.h"

namespace mortise::effects::contact {
namespace {

// Between whom is there a gap that counts?
class Meeting {
 public:
  Meeting(const Params& effect, const Params& scene) : scene_(scene), effects_(scene.at("effects")), listed_(effect.find("pairs")) {
    for (std::size_t i = 0; listed_ && i < listed_->items().size(); ++i) pairs_.push_back(named(listed_->items()[i]));
    for (const std::string& tie : of_role(effects_, Role::tie))
      for (const Params& p : effects_.at(tie).items()) ties_.push_back(&p);
  }
  bool operator()(const std::string& a, const std::string& b) const {
    if (pass(scene_, a, b) || (held(a) && held(b))) return false;
    if (listed_ && std::none_of(pairs_.begin(), pairs_.end(), [&](const std::set<std::string>& pair) { return pair.count(a) && pair.count(b); }))
      return false;
    return std::none_of(ties_.begin(), ties_.end(), [&](const Params* tie) {
      const std::string& body = tie->text("body");
      return tie->has("to") && ((body == a && tie->text("to") == b) || (body == b && tie->text("to") == a));
    });
  }

 private:
  // Is all of it pinned?
  bool held(const std::string& body) const {
    const std::vector<const Params*> pins = of_body(effects_, Role::support, body);
    return std::any_of(pins.begin(), pins.end(), [](const Params* pin) {
      const Params* where = pin->find("where");
      return where && where->has("side") && where->text("side") == "all";
    });
  }

  const Params &scene_, &effects_, *listed_;
  std::vector<std::set<std::string>> pairs_;  // that the effect lists
  std::vector<const Params*> ties_;
};

// Of the vertices of `a` to the surface of `b`, which lies in a box, both only where the other is nearer than `upto`.
double vertices_to_surface(const model::BodyInput& a, const model::BodyInput& b, const geometry::Bounds& box, double upto) {
  const geometry::Bounds near = box.grown(upto);
  std::vector<Vec3> vertices;
  for (const Vec3& x : a.nodes)
    if (near.holds(x)) vertices.push_back(x);
  const geometry::Bounds there = geometry::bounds_of(vertices).grown(upto);
  std::vector<Triangle> triangles;
  for (const Triangle& t : b.triangles) {
    geometry::Bounds own;
    for (const Index v : t.v) own.include(b.nodes[v]);
    if (own.meets(there)) triangles.push_back(t);
  }
  const geometry::NearestTriangle surface(b.nodes, triangles);
  double least = upto;
  for (const Vec3& x : vertices) least = std::min(least, surface.distance(x));
  return least;
}

}  // namespace

double start_gap(const Params& effect, const model::ModelInput& input, const std::vector<const model::BodyInput*>& bodies, Index env, double upto) {
  const Meeting meet(effect, input.scene);
  std::vector<geometry::Bounds> box;
  for (const model::BodyInput* body : bodies) box.push_back(geometry::bounds_of(body->nodes));
  double least = upto;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const model::BodyInput& a = *bodies[i];
    for (std::size_t j = i + 1; j < bodies.size(); ++j)
      if (const model::BodyInput& b = *bodies[j]; box[i].meets(box[j].grown(upto)) && meet(a.name, b.name))
        least = std::min({least, vertices_to_surface(a, b, box[j], upto), vertices_to_surface(b, a, box[i], upto)});
    for (const model::BodyInput& plane : input.bodies) {
      if (plane.type != model::BodyType::half_space || plane.env != env || !meet(a.name, plane.name)) continue;
      const Vec3 n = plane.params.vec3("normal").normalized(), o = plane.params.vec3("point");
      for (const Vec3& x : a.nodes) least = std::min(least, std::abs((x - o).dot(n)));
    }
  }
  return least;
}

}  // namespace mortise::effects::contact
