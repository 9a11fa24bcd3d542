#include "audit/motion_lag.h"

#include <algorithm>
#include <cmath>

#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {

MotionLag::MotionLag(const model::ModelInput& input) : walking_(input) {
  const Integration integration = integration_of(input.scene);
  if (!integration.second_order) step_ = integration.step;
  const Params* quantities = input.scene.find("quantities");
  for (std::size_t i = 0; quantities && i < quantities->items().size(); ++i) {
    const Params& q = quantities->items()[i];
    if (const std::string& when = q.text("when"); q.has("body") && (when == "largest" || when == "smallest" || when == "range"))
      asked_.insert(q.text("body"));
  }
}

void MotionLag::state(const std::vector<double>& points, const std::vector<MovingBody>& bodies) {
  walking_.state(points, bodies);
  if (std::isnan(step_) || bodies.empty()) return;
  const bool first = start_.empty();
  if (first) turned_.assign(3 * bodies.size(), 0.0), comes_.assign(bodies.size(), 0.0);
  if (!first) ++steps_;
  value_ = first ? NAN : 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec3 &x = bodies[i].x, &v = bodies[i].v, &w = bodies[i].w;
    if (first) {
      start_.insert(start_.end(), {x[0], x[1], x[2]});
      centres_.start(v, tuning::kStill * 2 * bodies[i].body.radius(x, points));
      turns_.start(w, tuning::kStill * 2);  // its rim goes a share of the body's size
      carried_.start(bodies[i], points);
      continue;
    }
    for (int a = 0; a < 3; ++a) turned_[3 * i + a] += step_ * w[a];
    const double of_centre = centres_.lag(i, x - at(start_, i), v, step_, steps_), of_turning = turns_.lag(i, at(turned_, i), w, step_, steps_);
    if (bodies[i].led) continue;
    value_ = std::max({value_, of_centre, of_turning, carried_.lag(i, bodies, step_, steps_)});
    const bool comes = v.dot(x - at(start_, i)) < 0;
    if (comes && comes_[i] == 0 && asked_.count(bodies[i].body.name)) turned_back_ = std::fmax(turned_back_, of_centre);
    comes_[i] = comes;
  }
}

void MotionLag::checkpoint(Archive& archive) {
  archive.io("lag.start", start_);
  archive.io("lag.turned", turned_);
  centres_.checkpoint(archive, "lag.centres");
  turns_.checkpoint(archive, "lag.turns");
  carried_.checkpoint(archive);
  walking_.checkpoint(archive);
  archive.io("lag.steps", steps_);
  archive.io("lag.value", value_);
  archive.io("lag.comes", comes_);
  archive.io("lag.turned_back", turned_back_);
}

}  // namespace mortise::audit
