#include "effects/pin/pin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "effects/failure.h"
#include "effects/list.h"
#include "effects/pin/orientation.h"
#include "effects/where.h"
#include "geometry/bounds.h"
#include "geometry/rigid_motion.h"
#include "model/model.h"
#include "model/points_of.h"
#include "model/select.h"

namespace mortise::effects {
namespace {

using param::of;
using param::optional;

const ParamTable kRotation{"pin rotation",
                           "Rotation about a fixed axis.",
                           {of(Param::Kind::vec3, "axis", Unit::none, "[0, 0, 1]", "Direction of the axis."),
                            of(Param::Kind::vec3, "centre", Unit::length, "[0, 0, 0]", "A point on the axis, world coordinates at rest."),
                            of(Param::Kind::numbers, "angle", Unit::angle, std::nullopt, "Angle at each key.")}};

const ParamTable kOrientation{
    "pin orientation",
    "Turns from rest as unit quaternions, one per key; in between about one axis, the shorter way.",
    {of(Param::Kind::vec3, "centre", Unit::length, "[0, 0, 0]", "The point that the body turns about, world coordinates at rest."),
     of(Param::Kind::numbers, "w", Unit::none, std::nullopt, "Cosine of half the angle, at each key."),
     of(Param::Kind::numbers, "x", Unit::none, std::nullopt, "Sine of half the angle times the axis."),
     of(Param::Kind::numbers, "y", Unit::none, std::nullopt, "The same, y."),
     of(Param::Kind::numbers, "z", Unit::none, std::nullopt, "The same, z.")}};

const ParamTable kTrack{
    "pin motion file",
    "Keys from a track of poses; the body stands in the scene as the first says.",
    {param::required(of(Param::Kind::path, "path", Unit::none, std::nullopt, "Table of comma-separated numbers, or HDF5 (.h5, .hdf5).")),
     optional(of(Param::Kind::names, "position", Unit::none, std::nullopt, "Columns of x, y and z of the tracked point.")),
     optional(of(Param::Kind::names, "quaternion", Unit::none, std::nullopt, "Columns of w, x, y and z of its turn, a unit quaternion.")),
     optional(of(Param::Kind::vec3, "centre", Unit::length, std::nullopt,
                 "Where the tracked point stands in the scene; without it at the first position of the track.")),
     of(Param::Kind::text, "time_column", Unit::none, "time", "Name of the column of times, which increase from row to row."),
     param::positive(optional(of(Param::Kind::number, "rate", Unit::none, std::nullopt,
                                 "Rows per second, in the place of a column of times [Hz]; the first is at t = 0."))),
     optional(param::choice("unit", {"m", "cm", "mm"}, "", "Unit of the positions, where their columns have none.")),
     optional(param::choice("time_unit", {"s", "ms"}, "", "Unit of the times, where their column has none."))}};

Param rotations() {
  Param p = param::table("rotation", &kRotation, "Rotation of the rest positions, before the translation; a list: one after the other.");
  p.kind = Param::Kind::tables;
  return p;
}

const ParamTable kMotion{
    "pin motion",
    "Keys that the motion passes.",
    {optional(of(Param::Kind::numbers, "time", Unit::time, std::nullopt, "Times of the keys, ascending (pseudo-time 0 to 1 in static scenes).")),
     optional(of(Param::Kind::vec3s, "translation", Unit::length, std::nullopt, "Translation at each key.")),
     param::choice("interpolation", {"linear", "smooth"}, "linear",
                   "Between keys: at constant speed, or by a cubic that starts and ends at rest and never overshoots a key."),
     rotations(), param::table("orientation", &kOrientation, "The same by quaternions."),
     param::table("file", &kTrack, "Times, translations and orientations from a file, in their place.")}};

const ParamTable kTable = [] {
  ParamTable t{
      "effect pin",
      "Holds or moves points exactly.",
      {of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of the body."),
       param::required(param::table("where", &where_table, "Points of the body that are held; a stiff body is held as a whole (side: all).")),
       of(Param::Kind::text, "axes", Unit::none, "xyz", "Directions that are held: any of x, y, z."),
       param::table("motion", &kMotion, "Prescribed motion; without it the points stay where they are."),
       optional(of(Param::Kind::number, "release", Unit::time, std::nullopt, "Time from which the points are free."))}};
  t.is_list = true;
  return t;
}();

// One list entry of the scene.
class Motion {
 public:
  explicit Motion(const Params& pin) {
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
      check(*list, keys);
      for (int a = 0; a < 3; ++a) {
        Params values = Params::make_list();
        for (const Params& key : list->items()) values.push(Params::make_number(key.as_vec3()[a]));
        translation_[a] = schedule(time, values);
      }
    }
    if (const Params* list = motion->find("rotation"))
      for (const Params& r : list->items()) {
        check(r.at("angle"), keys);
        const Vec3 axis = r.vec3("axis");
        if (!(axis.norm() > 0)) throw Error(Exit::scene, r.at("axis").where(), "axis of rotation has no direction");
        turns_.push_back({axis.normalized(), r.vec3("centre"), schedule(time, r.at("angle"))});
      }
    if (const Params* o = motion->find("orientation")) orientation_ = pin::Orientation(*o, time, smooth_);
  }

  bool moves() const { return moves_; }
  bool turns() const { return !turns_.empty() || orientation_.any(); }
  bool same_as(const Motion& other) const { return same(params_, other.params_); }
  pin::RigidMotion at(double t) const {
    pin::RigidMotion m{Mat3::Identity(), Vec3::Zero()};
    for (const Turn& turn : turns_) m = pin::turned(m, turn.axis, turn.centre, turn.angle(t));
    if (orientation_.any()) m = pin::turned(m, orientation_.at(t), orientation_.centre());
    m.shift += Vec3(translation_[0](t), translation_[1](t), translation_[2](t));
    return m;
  }

 private:
  static Schedule still() { return Schedule(Params::make_number(0)); }
  Schedule schedule(const Params& time, const Params& value) const {
    Params p = Params::make_table();
    p.set("time", time);
    p.set("value", value);
    return Schedule(p, smooth_);
  }
  static void check(const Params& list, std::size_t keys) {
    if (list.items().size() == keys) return;
    throw Error(Exit::scene, list.where(), "has " + std::to_string(list.items().size()) + " keys where 'time' has " + std::to_string(keys));
  }
  struct Turn {
    Vec3 axis, centre;
    Schedule angle;
  };
  static bool same(const Params& a, const Params& b) {
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

  bool moves_ = false, smooth_ = false;
  Params params_;
  Schedule translation_[3] = {still(), still(), still()};
  std::vector<Turn> turns_;
  pin::Orientation orientation_;
};

struct Entry {
  Motion motion;
  double release = std::numeric_limits<double>::infinity();  // [s]
  SourceLoc where;
  std::string body;
  double size = 0;                                                     // of the body, at rest [m]
  Vec3 lo = Vec3::Constant(INFINITY), hi = Vec3::Constant(-INFINITY);  // of what is held of it
};

constexpr std::uint8_t kAllAxes = 7;

// A held block: which list entry holds which of its axes.
struct Held {
  Index block;
  Index entry;
  std::uint8_t axes;  // bit a: axis a
  bool direction;     // a column of an affine body
};

class Pin final : public Effect {
 public:
  Pin(const Params& list, model::Model& model) : model_(model), per_env_(list.items().size()), owner_(3 * model.blocks, -1) {
    for (Index e = 0; e < model.envs; ++e)
      for (const Params& p : model.input.effect_of(list, e).items()) add(p, e);
    name_carriages();
    device_held_.upload(held_);
    active_.resize(model.envs);
    env_ = model.block_env.download();
    StepInfo before;
    before.t0 = -std::numeric_limits<double>::infinity();
    hold(before, 0);
    move({});
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override { return {{"held blocks", device_held_.bytes() + motions_.bytes()}}; }

  // Depends on nothing but the times, so that steps may be tried again and runs resumed anywhere.
  void begin_step(const StepInfo& step) override {
    hold(step, 1e-9 * step.dt);
    for (Index env = 0; env < model_.envs; ++env)
      for (const Entry& e : entries_of(env))
        if (step.taken_by(env) && e.motion.moves() && step.t0_of(env) < e.release) check_path(e, step, env);
    move(step);
  }

  // Points go straight from where they are to where they are asked to be at the end of the step, and what lies beside that way is not met: a
  // step has to be short enough for the prescribed way to be nearly straight.
  void check_path(const Entry& e, const StepInfo& step, Index env) const {
    constexpr int kSamples = 16;
    constexpr double kBow = 2e-3;  // of the size of the body: 7 degrees of a turn about its middle
    for (int c = 0; c < 8; ++c) {
      const Vec3 corner(c & 1 ? e.hi[0] : e.lo[0], c & 2 ? e.hi[1] : e.lo[1], c & 4 ? e.hi[2] : e.lo[2]);
      const auto at = [&](double t) { return pin::move_point(e.motion.at(t), corner); };
      const double t0 = step.t0_of(env);
      const Vec3 begin = at(t0), way = at(step.t1_of(env)) - begin;
      for (int k = 1; k < kSamples; ++k) {
        const Vec3 x = at(t0 + step.dt * k / kSamples) - begin;
        const double along = way.squaredNorm() > 0 ? std::clamp(x.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0;
        const double beside = (x - along * way).norm();
        if (beside <= kBow * e.size) continue;
        std::ostringstream why;
        why << "the motion prescribed for '" << e.body << "' leaves the straight way from the beginning to the end of a step of " << step.dt
            << (step.is_static ? "" : " s") << " by " << beside << " m: take shorter steps" << (step.is_static ? " (more of them)" : "")
            << ", or put the keys of the motion at their ends";
        throw Failure{why.str(), env};
      }
    }
  }
  void energy(Positions, const Linearisation&, device::EnvValues) override {}
  void linearise(Positions, Want, Linearisation&) override {}

  // Writes the targets of the end of the step, of the environments that take it.
  void move(const StepInfo& step) {
    std::vector<std::uint8_t> taken;
    for (Index e = 0; e < model_.envs; ++e) taken.push_back(step.taken_by(e));
    const device::Buffer<std::uint8_t> mask(taken);
    const View<const std::uint8_t> mine = mask.view();
    const View<const Index> env = std::as_const(model_.block_env).view();
    std::vector<pin::RigidMotion> motions;
    for (Index e = 0; e < model_.envs; ++e)
      for (const Entry& entry : entries_of(e)) motions.push_back(entry.motion.at(step.t1_of(e)));
    motions_.upload(motions);
    const View<const pin::RigidMotion> motion = std::as_const(motions_).view();
    const View<const Held> held = std::as_const(device_held_).view();
    const View<const Vec3> rest = std::as_const(model_.rest).view();
    const View<Vec3> target = model_.target.view();
    device::parallel_for("pin.target", held.n, [=] MORTISE_HD(Index i) {
      const Held h = held[i];
      if (!mine[env[h.block]]) return;
      const Vec3 x = h.direction ? pin::move_direction(motion[h.entry], rest[h.block]) : pin::move_point(motion[h.entry], rest[h.block]);
      for (int a = 0; a < 3; ++a)
        if (h.axes >> a & 1) target[h.block][a] = x[a];
    });
  }

 private:
  std::span<const Entry> entries_of(Index env) const { return std::span(entries_).subspan(env * per_env_, per_env_); }

  void add(const Params& p, Index env) {
    const std::string& name = p.text("body");
    const std::uint8_t axes = parse_axes(p.at("axes"));
    entries_.push_back({Motion(p), std::numeric_limits<double>::infinity(), p.where(), name});
    if (p.has("release")) entries_.back().release = p.number("release");
    bool found = false;
    for (const model::Body& body : model_.bodies) {
      if (body.env != env || body.name != name) continue;
      found = true;
      entries_.back().size = size_of(body);
      if (body.type == model::BodyType::stiff)
        add_stiff(p, body, axes);
      else
        add_soft(p, body, axes);
    }
    if (!found) throw Error(Exit::scene, p.at("body").where(), "no soft or stiff body is named '" + name + "'");
  }

  void add_stiff(const Params& p, const model::Body& body, std::uint8_t axes) {
    const Params& where = p.at("where");
    if (!where.has("side") || where.text("side") != "all" || axes != kAllAxes)
      throw Error(Exit::scene, where.where(), "stiff body '" + body.name + "' can only be held as a whole: where: {side: all}, axes: xyz");
    const std::vector<Vec3> rest = model_.rest_points.download();
    for (Index point = body.point_begin; point < body.point_end; ++point) include(rest[point]);
    for (Index b = body.block_begin; b < body.block_end; ++b) hold_block(b, axes, b > body.block_begin, body);
  }

  void add_soft(const Params& p, const model::Body& body, std::uint8_t axes) {
    const std::vector<Index> points = model::select_points(model_, body, p.at("where"));
    const std::vector<Vec3> rest = model_.rest_points.download();
    if (points.empty()) model::selects_nothing(p.at("where"), "node", body.name, model::points_of(body, rest));
    const std::vector<Index> offset = model_.point_offset.download(), block = model_.point_block.download();
    std::vector<Vec3> held;
    for (Index point : points) include(rest[point]), held.push_back(rest[point]);
    for (Index point : points) hold_block(block[offset[point]], axes, false, body);
    const Entry& e = entries_.back();
    if (axes == kAllAxes && std::isinf(e.release) && !e.motion.turns() && geometry::fixes_a_frame(held))
      model_.bodies[&body - model_.bodies.data()].stays = true;
  }

  double size_of(const model::Body& body) const {
    const std::vector<Vec3> rest = model_.rest_points.download();
    return geometry::bounds_of(model::points_of(body, rest)).size().norm();
  }
  void include(const Vec3& x) { entries_.back().lo = entries_.back().lo.cwiseMin(x), entries_.back().hi = entries_.back().hi.cwiseMax(x); }

  // Adds what the newest entry holds of a block. Two entries may share an axis of a node only if both merely hold it.
  void hold_block(Index block, std::uint8_t axes, bool direction, const model::Body& body) {
    const Index mine = static_cast<Index>(entries_.size()) - 1;
    const Entry& e = entries_[mine];
    for (int a = 0; a < 3; ++a) {
      if (!(axes >> a & 1)) continue;
      const Index other = owner_[3 * block + a];
      if (other < 0) {
        owner_[3 * block + a] = mine;
        continue;
      }
      const Entry& o = entries_[other];
      if (e.motion.moves() || o.motion.moves() || e.release != o.release)
        throw Error(Exit::scene, e.where,
                    "moves points of body '" + body.name + "' along " + "xyz"[a] + " that the pin at " + o.where.text() + " holds too");
      axes &= static_cast<std::uint8_t>(~(1 << a));
    }
    if (axes) held_.push_back({block, mine, axes, direction});
  }

  // Bodies that are held wholly and for ever; those by equal motions move as one (model/model.h).
  void name_carriages() {
    std::vector<const Motion*> carriages;
    for (const Entry& e : entries_) model_.driven |= e.motion.moves();
    for (model::Body& body : model_.bodies) {
      const Index first = owner_[3 * body.block_begin];
      bool wholly = true, as_one = true;
      for (Index i = 3 * body.block_begin; i < 3 * body.block_end && wholly; ++i) {
        wholly = owner_[i] >= 0 && std::isinf(entries_[owner_[i]].release);
        as_one = as_one && wholly && entries_[owner_[i]].motion.same_as(entries_[first].motion);
      }
      if (!wholly) continue;
      const Motion& motion = entries_[first].motion;
      if (as_one && !motion.moves()) {
        body.carriage = model::Body::kStill;
        continue;
      }
      const auto known =
          as_one ? std::find_if(carriages.begin(), carriages.end(), [&](const Motion* m) { return m && m->same_as(motion); }) : carriages.end();
      body.carriage = 1 + static_cast<Index>(known - carriages.begin());
      if (known == carriages.end()) carriages.push_back(as_one ? &motion : nullptr);  // one whose parts move apart is alone
    }
  }

  static std::uint8_t parse_axes(const Params& p) {
    std::uint8_t axes = 0;
    for (char c : p.as_text()) {
      if (c < 'x' || c > 'z' || (axes >> (c - 'x') & 1))
        throw Error(Exit::scene, p.where(), "axes '" + p.as_text() + "': give x, y, z, each at most once");
      axes |= static_cast<std::uint8_t>(1 << (c - 'x'));
    }
    if (axes == 0) throw Error(Exit::scene, p.where(), "axes: holds nothing");
    return axes;
  }

  // Projectors and `held` of a step; touches the model only when an entry was released since.
  void hold(const StepInfo& step, double tolerance) {
    bool changed = false;
    for (Index e = 0; e < model_.envs; ++e) {
      std::vector<bool> active;
      for (const Entry& entry : entries_of(e)) active.push_back(step.t0_of(e) < entry.release - tolerance);
      if (!step.taken_by(e) || active == active_[e]) continue;
      active_[e] = active;
      changed = true;
    }
    if (!changed) return;
    std::vector<Mat3> projector = model_.projector.download();
    for (const Held& h : held_) projector[h.block] = Mat3::Identity(), model_.held[h.block] = 0;
    for (const Held& h : held_)
      for (int a = 0; a < 3; ++a)
        if (active_[env_[h.block]][static_cast<std::size_t>(h.entry) % per_env_] && (h.axes >> a & 1)) projector[h.block](a, a) = 0;
    for (const Held& h : held_) {
      const double free = projector[h.block].trace();
      model_.held[h.block] = free == 3 ? 0 : (free == 0 ? 2 : 1);
    }
    model_.projector.upload(projector);
  }

  model::Model& model_;
  std::vector<Entry> entries_;  // of every environment
  const std::size_t per_env_;
  std::vector<Held> held_;
  std::vector<Index> owner_;               // per block and axis: the entry that holds it, or -1
  std::vector<std::vector<bool>> active_;  // of every environment: which entries hold
  std::vector<Index> env_;                 // of every block
  device::Buffer<Held> device_held_;
  device::Buffer<pin::RigidMotion> motions_;
};

}  // namespace

const Kind& pin_kind() {
  static const Kind kind = Kind{
      "pin",
      Role::support,
      "points held or moved exactly",
      &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Pin>(p, m); },
      {},
      {"support_force"}}.differing_in({"motion", "release", "where"});
  return kind;
}

const Kind& Pin::kind() const { return pin_kind(); }

}  // namespace mortise::effects
