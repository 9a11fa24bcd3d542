#include "audit/load_turned.h"

#include <cmath>
#include <map>
#include <set>

#include "audit/vector_at.h"
#include "effects/roles.h"
#include "model/select.h"

namespace mortise::audit {
namespace {

Vec3 area(const Vec3 (&x)[3]) { return 0.5 * (x[1] - x[0]).cross(x[2] - x[0]); }

}  // namespace

LoadTurned::LoadTurned(const model::ModelInput& input) {
  const Params& effects = input.scene.at("effects");
  std::map<std::string, std::pair<const model::BodyInput*, std::size_t>> bodies;  // and their first points
  std::size_t first = 0;
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    bodies[body.name] = {&body, first};
    first += body.nodes.size();
  }
  for (const std::string& name : effects::of_role(effects, effects::Role::load)) {
    const Params& list = effects.at(name);
    if (list.kind() != Params::Kind::list) continue;
    for (const Params& load : list.items()) {
      if (!load.has("pressure") || !load.has("body") || !bodies.count(load.text("body"))) continue;
      const auto& [body, begin] = bodies.at(load.text("body"));
      const std::vector<Index> chosen = model::select(body->nodes, load.at("where"));
      const std::set<Index> in(chosen.begin(), chosen.end());
      std::vector<Face> faces;
      for (const Triangle& t : body->triangles) {
        if (!(in.count(t.v[0]) && in.count(t.v[1]) && in.count(t.v[2]))) continue;
        Face& face = faces.emplace_back();
        for (int k = 0; k < 3; ++k) face.point[k] = begin + static_cast<std::size_t>(t.v[k]), face.rest[k] = body->nodes[t.v[k]];
      }
      if (!faces.empty()) loads_.push_back(std::move(faces));
    }
  }
}

double LoadTurned::of(std::span<const double> displacement) const {
  double worst = NAN;
  for (const std::vector<Face>& faces : loads_) {
    double turned = 0, all = 0;
    for (const Face& face : faces) {
      Vec3 now[3];
      for (int k = 0; k < 3; ++k) now[k] = face.rest[k] + at(displacement, face.point[k]);
      const Vec3 rest = area(face.rest);
      turned += (area(now) - rest).squaredNorm(), all += rest.squaredNorm();
    }
    if (all > 0) worst = std::fmax(worst, std::sqrt(turned / all));
  }
  return worst;
}

}  // namespace mortise::audit
