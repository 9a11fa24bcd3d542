#include "effects/pin/motion.h"

#include <algorithm>

#include "base/error.h"

namespace mortise::effects::pin {
namespace {

void check_keys(const Params& list, std::size_t keys) {
  if (list.items().size() == keys) return;
  throw Error(Exit::scene, list.where(), "has " + std::to_string(list.items().size()) + " keys where 'time' has " + std::to_string(keys));
}

bool same(const Params& a, const Params& b) {
  if (a.kind() == Params::Kind::table && b.kind() == Params::Kind::table) {
    const auto &left = a.entries(), &right = b.entries();
    return std::equal(left.begin(), left.end(), right.begin(), right.end(),
                      [](const auto& l, const auto& r) { return l.first == r.first && same(l.second, r.second); });
  }
  if (a.kind() == Params::Kind::list && b.kind() == Params::Kind::list)
    return std::equal(a.items().begin(), a.items().end(), b.items().begin(), b.items().end(), same);
  if (a.kind() == Params::Kind::none || b.kind() == Params::Kind::none) return a.kind() == b.kind();
  if (a.kind() == Params::Kind::text || b.kind() == Params::Kind::text) return a.kind() == b.kind() && a.as_text() == b.as_text();
  return a.as_number() == b.as_number();
}

}  // namespace

Motion::Motion(const Params& pin) {
  const Params* motion = pin.find("motion");
  if (!motion) return;
  moves_ = true;
  smooth_ = motion->text("interpolation") == "smooth";
  params_ = *motion;
  if (!motion->has("time")) throw Error(Exit::scene, motion->where(), "motion needs 'time', the times of its keys, or 'file'");
  const Params& time = motion->at("time");
  const std::size_t keys = time.items().size();
  if (keys == 0) throw Error(Exit::scene, time.where(), "motion needs at least one key");
  for (std::size_t k = 1; k < keys; ++k)
    if (!(time.items()[k].as_number() > time.items()[k - 1].as_number())) throw Error(Exit::scene, time.where(), "times of the keys must ascend");
  if (!motion->has("translation") && !motion->has("rotation") && !motion->has("orientation"))
    throw Error(Exit::scene, motion->where(), "motion needs 'translation', 'rotation' or 'orientation'");
  if (const Params* list = motion->find("translation")) {
    check_keys(*list, keys);
    for (int a = 0; a < 3; ++a) {
      Params values = Params::make_list();
      for (const Params& key : list->items()) values.push(Params::make_number(key.as_vec3()[a]));
      translation_[a] = schedule(time, values);
    }
  }
  if (const Params* list = motion->find("rotation"))
    for (const Params& r : list->items()) {
      check_keys(r.at("angle"), keys);
      const Vec3 axis = r.vec3("axis");
      if (!(axis.norm() > 0)) throw Error(Exit::scene, r.at("axis").where(), "axis of rotation has no direction");
      turns_.push_back({axis.normalized(), r.vec3("centre"), schedule(time, r.at("angle"))});
    }
  if (const Params* o = motion->find("orientation")) orientation_ = Orientation(*o, time, smooth_);
}

bool Motion::same_as(const Motion& other) const { return same(params_, other.params_); }

RigidMotion Motion::at(double t) const {
  RigidMotion m{Mat3::Identity(), Vec3::Zero()};
  for (const Turn& turn : turns_) m = turned(m, turn.axis, turn.centre, turn.angle(t));
  if (orientation_.any()) m = turned(m, orientation_.at(t), orientation_.centre());
  m.shift += Vec3(translation_[0](t), translation_[1](t), translation_[2](t));
  return m;
}

Schedule Motion::schedule(const Params& time, const Params& value) const {
  Params p = Params::make_table();
  p.set("time", time);
  p.set("value", value);
  return Schedule(p, smooth_);
}

}  // namespace mortise::effects::pin
