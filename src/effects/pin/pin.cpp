#include "effects/pin/pin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "base/complaints.h"
#include "effects/failure.h"
#include "effects/list.h"
#include "effects/pin/motion.h"
#include "effects/pin/table.h"
#include "geometry/bounds.h"
#include "geometry/rigid_motion.h"
#include "model/model.h"
#include "model/points_of.h"
#include "model/select.h"

namespace mortise::effects {
namespace {

struct Entry {
  pin::Motion motion;
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
    Complaints wrong;
    for (Index e = 0; e < model.envs; ++e)
      for (const Params& p : model.input.effect_of(list, e).items()) wrong.gather([&] { add(p, e); });
    wrong.raise();
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
    hold(step, kSameTime * step.dt);
    for (Index env = 0; env < model_.envs; ++env)
      for (const Entry& e : entries_of(env))
        if (step.taken_by(env) && e.motion.moves() && step.t0_of(env) < e.release) check_path(e, step, env);
    move(step);
  }

  bool lets_go(const StepInfo& step, Index env) const override {
    const double t0 = step.t0_of(env), tolerance = kSameTime * step.dt;
    const auto entries = entries_of(env);
    return std::any_of(entries.begin(), entries.end(), [&](const Entry& e) { return holds(e, t0 - step.dt, tolerance) && !holds(e, t0, tolerance); });
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
    entries_.push_back({pin::Motion(p), std::numeric_limits<double>::infinity(), p.where(), name});
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
    std::vector<const pin::Motion*> carriages;
    for (const Entry& e : entries_) model_.driven |= e.motion.moves();
    for (model::Body& body : model_.bodies) {
      const Index first = owner_[3 * body.block_begin];
      bool wholly = true, as_one = true;
      for (Index i = 3 * body.block_begin; i < 3 * body.block_end && wholly; ++i) {
        wholly = owner_[i] >= 0 && std::isinf(entries_[owner_[i]].release);
        as_one = as_one && wholly && entries_[owner_[i]].motion.same_as(entries_[first].motion);
      }
      if (!wholly) continue;
      const pin::Motion& motion = entries_[first].motion;
      if (as_one && !motion.moves()) {
        body.carriage = model::Body::kStill;
        continue;
      }
      const auto known =
          as_one ? std::find_if(carriages.begin(), carriages.end(), [&](const pin::Motion* m) { return m && m->same_as(motion); }) : carriages.end();
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

  static constexpr double kSameTime = 1e-9;  // of a step: times are sums of steps
  // In a step that begins then.
  static bool holds(const Entry& e, double time, double tolerance) { return time < e.release - tolerance; }

  // Projectors and `held` of a step; touches the model only when an entry was released since.
  void hold(const StepInfo& step, double tolerance) {
    bool changed = false;
    for (Index e = 0; e < model_.envs; ++e) {
      std::vector<bool> active;
      for (const Entry& entry : entries_of(e)) active.push_back(holds(entry, step.t0_of(e), tolerance));
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
      &pin::table(),
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> { return std::make_unique<Pin>(p, m); },
      {},
      {"support_force"}}.differing_in({"motion", "release", "where"});
  return kind;
}

const Kind& Pin::kind() const { return pin_kind(); }

}  // namespace mortise::effects
