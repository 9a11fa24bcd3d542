#include "audit/touch_lag.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "audit/holds.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "effects/roles.h"

namespace mortise::audit {

TouchLag::TouchLag(const model::ModelInput& input) : supports_(input) {
  const Params& effects = input.scene.at("effects");
  const Holds holds(effects);
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    bodies_.push_back({rest_.size(), in.nodes.size(), in.type == model::BodyType::soft, holds.given(in.name)});
    rest_.insert(rest_.end(), in.nodes.begin(), in.nodes.end());
  }
  nodes_.resize(rest_.size());
  rubs_ = !effects::of_role(effects, effects::Role::follower).empty();
}

void TouchLag::move_supports(const Snapshot& said, const Snapshot::Values& displacement) {
  const LayerError::Fields fields{displacement, of_points(said, "support_force", 3), of_points(said, "tie_force", 3), {}, {}};
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    body.before = body.now;
    if (!body.given) continue;
    const auto supports = supports_.motion_of_supports(b, fields);
    body.now = supports ? *supports : supports_.motion(b, fields);  // a stiff body, or one whose supports bear nothing, goes as they do
  }
}

void TouchLag::state(const Snapshot& said) {
  if (!rubs_) return;
  const Snapshot::Values *displacement = said.of_points("displacement", 3), *contact = said.of_points("contact_force", 3),
                         *friction = said.of_points("friction_force", 3);
  if (!displacement || !contact || !friction) return;
  move_supports(said, *displacement);
  std::map<std::size_t, std::set<std::size_t>> others;  // that a body touches
  for (const auto& [name, values] : said.row) {
    if (leaf_of(name) != "bodies" && leaf_of(name) != "guard_bodies") continue;
    const auto force = said.row.find(group_of(name) + (leaf_of(name) == "bodies" ? "/force" : "/guard_force"));
    for (std::size_t i = 0; force != said.row.end() && i < force->second.size(); ++i) {
      const auto a = static_cast<std::size_t>(values[2 * i]), b = static_cast<std::size_t>(values[2 * i + 1]);
      if (force->second[i] > 0 && a != b) others[a].insert(b), others[b].insert(a);
    }
  }
  pressed_.clear();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    if (!bodies_[b].soft || !bodies_[b].given) continue;
    const std::set<std::size_t>& touched = others[b];
    const bool follow = touched.size() == 1 && (*touched.begin() >= bodies_.size() || bodies_[*touched.begin()].given);
    if (follow)
      touch(b, *touched.begin(), {*displacement, *contact, *friction});
    else
      std::fill_n(nodes_.begin() + static_cast<long>(bodies_[b].first), bodies_[b].count, Node());
  }
  before_ = *displacement;
}

Vec3 TouchLag::gone(std::size_t point, const Fields& f) const {
  return before_.empty() ? Vec3(Vec3::Zero()) : Vec3(at(f.displacement, point) - at(before_, point));
}

// As it goes along with the body's supports.
Vec3 TouchLag::led(std::size_t body, const Vec3& x) const {
  if (body >= bodies_.size()) return Vec3::Zero();
  const Body& b = bodies_[body];
  return x - b.before.R * (b.now.R.transpose() * (x - b.now.t)) - b.before.t;
}

Vec3 TouchLag::gone_at(std::size_t body, const Vec3& x, const Fields& f) const {
  if (body >= bodies_.size() || !bodies_[body].soft) return led(body, x);
  const Body& b = bodies_[body];
  std::size_t nearest = b.first;
  double least = INFINITY;
  for (std::size_t i = b.first; i < b.first + b.count; ++i) {
    if (at(f.contact, i).isZero(0)) continue;
    if (const double d = (rest_[i] + at(f.displacement, i) - x).squaredNorm(); d < least) least = d, nearest = i;
  }
  return gone(nearest, f);
}

void TouchLag::touch(std::size_t body, std::size_t other, const Fields& f) {
  const Body& own = bodies_[body];
  Vec3 pressed = Vec3::Zero();
  double all = 0;
  for (std::size_t i = own.first; i < own.first + own.count; ++i) pressed += at(f.contact, i), all += at(f.contact, i).norm();
  if (!(pressed.norm() > 0)) return;
  const Vec3 n = pressed.normalized();
  const auto across = [&](const Vec3& v) { return Vec3(v - n.dot(v) * n); };
  for (std::size_t i = own.first; i < own.first + own.count; ++i) {
    Node& node = nodes_[i];
    if (at(f.contact, i).isZero(0)) {
      node = {};
      continue;
    }
    const Vec3 x = rest_[i] + at(f.displacement, i), D = across(led(other, x) - led(body, x));
    const double force = at(f.contact, i).norm(), held = std::min(1.0, node.force / force);
    node.force = force;
    node.late *= held, node.begun = (1 - held) * D.norm() / 2;
    node.slip = across(gone(i, f) - gone_at(other, x, f)).norm();
    node.way += D;
    node.friction = at(f.friction, i);
  }
  pressed_[{body, other}] = all;
}

void TouchLag::step(long substeps) {
  // In all parts but that in which it began to touch it slipped without friction.
  const double part = 1 / static_cast<double>(std::max(1L, substeps));
  for (Node& node : nodes_)
    if (node.force > 0) node.late = std::max(0.0, node.late + part * node.begun - std::max(0.0, node.slip - (1 - part) * node.begun));
  now_.clear();
  for (const auto& [bodies, pressed] : pressed_) {
    now_[bodies] = judge(bodies.first, pressed);
    Judged& most = most_.try_emplace(bodies, now_[bodies]).first->second;
    if (now_[bodies].sheared > most.sheared) most = now_[bodies];
  }
}

TouchLag::Judged TouchLag::judge(std::size_t body, double pressed) const {
  double sheared = 0, error = 0;  // [N]
  for (std::size_t i = bodies_[body].first; i < bodies_[body].first + bodies_[body].count; ++i) {
    const double way = nodes_[i].way.norm();
    if (!(way > 0)) continue;
    const double along = nodes_[i].friction.dot(nodes_[i].way) / way;
    sheared += along, error += along * std::min(1.0, nodes_[i].late / way);
  }
  const double of = std::max(std::abs(sheared), tuning::kAcross * pressed);
  return {of, of > 0 ? tuning::kSoftened * std::abs(error) / of : 0};
}

double TouchLag::share() const {
  if (!rubs_) return NAN;
  double out = 0;
  for (const auto& [bodies, judged] : most_) {
    out = std::max(out, judged.lag);
    if (const auto now = now_.find(bodies); now != now_.end() && now->second.sheared > tuning::kStillLoaded * judged.sheared)
      out = std::max(out, now->second.lag);
  }
  return out;
}

void TouchLag::checkpoint(Archive& archive) {
  std::vector<double> touching, moved, judged;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (const Node& n = nodes_[i]; n.force > 0)
      touching.insert(touching.end(), {static_cast<double>(i), n.force, n.way[0], n.way[1], n.way[2], n.late});
  for (const Body& b : bodies_) {
    moved.insert(moved.end(), b.now.R.data(), b.now.R.data() + 9);
    moved.insert(moved.end(), b.now.t.data(), b.now.t.data() + 3);
  }
  for (const auto& [bodies, most] : most_)
    judged.insert(judged.end(), {static_cast<double>(bodies.first), static_cast<double>(bodies.second), most.sheared, most.lag});
  archive.io("touch_lag.touching", touching);
  archive.io("touch_lag.moved", moved);
  archive.io("touch_lag.most", judged);
  archive.io("touch_lag.before", before_);
  if (!archive.loading()) return;
  std::fill(nodes_.begin(), nodes_.end(), Node());
  for (std::size_t k = 0; k + 5 < touching.size(); k += 6)
    nodes_.at(static_cast<std::size_t>(touching[k])) = {touching[k + 1], Vec3(touching[k + 2], touching[k + 3], touching[k + 4]), touching[k + 5]};
  for (std::size_t b = 0; 12 * b + 11 < moved.size(); ++b)
    bodies_.at(b).now = {Eigen::Map<const Mat3>(moved.data() + 12 * b), Eigen::Map<const Vec3>(moved.data() + 12 * b + 9)};
  most_.clear(), now_.clear(), pressed_.clear();
  for (std::size_t k = 0; k + 3 < judged.size(); k += 4)
    most_[{static_cast<std::size_t>(judged[k]), static_cast<std::size_t>(judged[k + 1])}] = {judged[k + 2], judged[k + 3]};
}

}  // namespace mortise::audit
