#include "effects/contact/proximity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "effects/body_blocks.h"
#include "effects/contact/active.h"
#include "geometry/collide/step_limit.h"

namespace mortise::effects::contact {
namespace {

std::vector<Index> vertex_environments(const geometry::Surface& surface) {
  const std::vector<Index> env = surface.env.download();
  std::vector<Index> out;
  for (Index v : surface.vertices.download()) out.push_back(env[v]);
  return out;
}

double farthest(const std::vector<double>& reach) { return *std::max_element(reach.begin(), reach.end()); }

template <class F>
std::vector<std::uint8_t> where(const std::vector<Watch>& pairs, F is) {
  std::vector<std::uint8_t> out;
  for (Watch w : pairs) out.push_back(is(w) ? 1 : 0);
  return out;
}

// Range of every point towards its own body (pair_energy.h): tuning::kSelfRange of its distance at rest, at most the reach of its environment.
std::vector<double> self_ranges(model::Model& model, const std::vector<double>& reach, const std::vector<Index>& point_env) {
  Candidates at_rest(model.broadphase(), farthest(reach) / tuning::kSelfRange, point_env);
  std::vector<std::uint8_t> finite;
  at_rest.cover(model.rest_points, finite);
  const View<const PointTriangle> near = at_rest.point_triangles();
  Buffer<double> distance(near.n);
  Buffer<Index> point(near.n);
  const View<double> d = distance.view();
  const View<Index> p = point.view();
  const View<const Vec3> rest = std::as_const(model.rest_points).view();
  const geometry::SurfaceView surface = model.surface.view();
  device::parallel_for("contact.rest_distance", near.n, [=] MORTISE_HD(Index i) {
    Vec3 x[4];
    gather(rest, near[i].v, x);
    const bool own = surface.body[near[i].v[0]] == surface.body[near[i].v[1]];
    p[i] = near[i].point;
    d[i] = own ? std::sqrt(geometry::closest_point_triangle(x).squared) : static_cast<double>(INFINITY);
  });
  std::vector<double> range;
  for (Index e = 0; e < model.envs; ++e) range.resize(point_env[e + 1], reach[e]);
  const std::vector<double> found = distance.download();
  const std::vector<Index> whose = point.download();
  for (std::size_t i = 0; i < found.size(); ++i) range[whose[i]] = std::min(range[whose[i]], tuning::kSelfRange * found[i]);
  return range;
}

}  // namespace

Proximity::Proximity(model::Model& model, std::vector<double> reach)
    : model_(model),
      reach_(std::move(reach)),
      reaches_(reach_),
      topology_(model.surface, model.points),
      point_env_(env_offsets(model.surface.env.download(), model.envs)),
      vertex_env_(env_offsets(vertex_environments(model.surface), model.envs)),
      candidates_(model.broadphase(), farthest(reach_), point_env_),
      prescribed_(model) {
  std::vector<Plane> planes;
  for (const model::HalfSpace& h : model.half_spaces) planes.push_back({h.point, h.normal});
  planes_.upload(planes);
}

void Proximity::scale_reach(double by) {
  for (double& r : reach_) r *= by;
  reaches_.upload(reach_);
}

void Proximity::watch(const WatchedPairs& pairs) {
  const std::vector<std::uint8_t> apart = where(pairs.how, [](Watch w) { return w != Watch::no; });
  model_.watch(apart);
  watched_.upload(where(pairs.how, [](Watch w) { return w == Watch::contact; }));
  apart_.upload(apart);
  for (Index a = 0; a < pairs.of.bodies(); ++a)
    if (apart[pairs.of.of(a, a)]) return self_range_.upload(self_ranges(model_, reach_, point_env_));
}

std::vector<std::uint8_t> Proximity::locate(Positions q, Buffer<Vec3>& y) {
  std::vector<std::uint8_t> finite;
  model_.points_of(q, y);
  candidates_.cover(y, finite, model_.at_work);
  return finite;
}

void Proximity::require(const Buffer<Vec3>& y, device::EnvValues per_env) {
  const auto look = std::make_shared<Candidates::Look>();
  candidates_.look(y, model_.at_work, *look, per_env.fetch);
  per_env.fetch.then([this, look, &y, &value = per_env.value] {
    std::vector<std::uint8_t> finite;
    candidates_.settle(y, *look, finite);
    forbid(finite, value);
  });
}

const Candidates& Proximity::candidates(const Buffer<Vec3>& y) {
  std::vector<std::uint8_t> finite;
  candidates_.cover(y, finite, model_.at_work);
  return candidates_;
}

namespace {

// How far a way is free, of every environment, and what meets on it.
struct Way {
  std::vector<double> limit, share;  // the latter: how much of what was to be gone was looked at
  std::shared_ptr<const Prescribed::Meetings> meetings;

  explicit Way(Index envs) : limit(envs), share(envs, 1.0) {}

  double of_all(std::size_t env) const { return share[env] == 1 ? limit[env] : share[env] * std::min(1.0, limit[env]); }

  void look(const BarrierView& s, const geometry::ChosenPairs& pairs, View<const Vec3> y, View<const Vec3> dy, Prescribed& prescribed,
            device::Fetch& fetch) {
    limit.assign(limit.size(), INFINITY);
    meetings = prescribed.look(s, pairs, y, dy, fetch);
    geometry::limit_step(pairs, y, dy, tuning::kKeep, {limit, fetch});
  }
};

}  // namespace

std::shared_ptr<const Buffer<Vec3>> Proximity::limit(const Buffer<Vec3>& from, View<const Vec3> dq, const BarrierView& s, device::EnvValues alpha) {
  auto dy = std::make_shared<Buffer<Vec3>>();
  model_.points_of(dq, *dy);
  const BarrierView all = obstacles(s);
  const View<const Vec3> y = from.view(), step = std::as_const(*dy).view();
  // Pairs are picked from what the broad phase keeps on the guess that it serves; where that turns out wrong, they are searched and looked at again.
  auto way = std::make_shared<Way>(model_.envs);
  const std::shared_ptr<geometry::Broadphase::Guess> guess = candidates_.guess(from, *dy, model_.at_work, alpha.fetch);
  if (guess->answers) way->look(all, guess->pairs, y, step, prescribed_, alpha.fetch);
  alpha.fetch.then([this, guess, way, dy, all, &from, whose = model_.at_work, info = step_, &value = alpha.value] {
    geometry::ChosenPairs pairs = guess->pairs;
    if (!candidates_.take(*guess, from, *dy, whose)) {
      device::Fetch again;
      const std::unique_ptr<geometry::Broadphase::Guess> found = candidates_.search(from, *dy, whose, *guess, way->share, again);
      pairs = found ? found->pairs : candidates_.broadphase().pairs();
      way->look(all, pairs, from.view(), std::as_const(*dy).view(), prescribed_, again);
      again.now("way after search");
      if (found) candidates_.take(*found, from, *dy, whose);
    }
    if (way->meetings) prescribed_.check(*way->meetings, all, pairs, info);
    for (std::size_t e = 0; e < value.size(); ++e) value[e] = device::Smaller()(value[e], way->of_all(e));
  });
  limit_planes(all, y, step, tuning::kKeep, model_.working(vertex_env_), alpha);
  return dy;
}

BarrierView Proximity::view(const BarrierParams& barrier, const Buffer<double>& kappa, View<const double> point_area,
                            View<const double> plane_area) const {
  return {barrier,
          reaches_.view(),
          kappa.view(),
          model_.surface.view(),
          topology_.view(),
          std::as_const(model_.rest_points).view(),
          watched_.view(),
          planes_.view(),
          self_range_.view(),
          point_area,
          plane_area};
}

void forbid(const std::vector<std::uint8_t>& finite, std::vector<double>& value) {
  for (std::size_t e = 0; e < value.size(); ++e)
    if (!finite[e] || std::isnan(value[e])) value[e] = INFINITY;
}

}  // namespace mortise::effects::contact
