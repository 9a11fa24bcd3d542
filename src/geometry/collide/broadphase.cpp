#include "geometry/collide/broadphase.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/bounds.h"
#include "geometry/collide/tuning.h"

namespace mortise::geometry {
namespace {

using device::Buffer;
using device::View;

// The pairs of `from` among `whose` whose swept boxes overlap; `counts`: scratch.
template <class Pair, class Near>
void mark(const char* name, const Buffer<Pair>& from, const device::Ranges& whose, Buffer<Index>& counts, Near near) {
  counts.resize(from.size() + 1);
  if (whose.size() < from.size()) counts.zero();
  const View<Index> count = counts.view();
  const View<const Pair> pair = from.view();
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) { count[i] = near(pair[i]) ? 1 : 0; });
}

bool any(const std::vector<std::uint8_t>& whose) { return std::find(whose.begin(), whose.end(), 1) != whose.end(); }
bool all(const std::vector<std::uint8_t>& whose) { return std::find(whose.begin(), whose.end(), 0) == whose.end(); }

template <class Pair>
void compact(const char* name, const Buffer<Pair>& from, const device::Ranges& whose, const Buffer<Index>& counts, Buffer<Pair>& to) {
  const View<const Index> at = counts.view();
  const View<const Pair> pair = from.view();
  const View<Pair> out = to.view();
  device::parallel_for(name, whose, [=] MORTISE_HD(Index i) {
    if (at[i + 1] > at[i]) out[at[i]] = pair[i];
  });
}

// Marks the pairs that a search at (y, dy) finds, out of those kept.
void mark_near(const SurfaceView& surface, const NearPairs& kept, View<const Vec3> y, View<const Vec3> dy, double radius,
               const std::vector<std::uint8_t>& whose, Buffer<Index>& pt_counts, Buffer<Index>& ee_counts) {
  const SurfaceView s = surface;
  const double grow = radius / 2;
  mark("broadphase.near_point_triangle", kept.point_triangles, {kept.pt_env_offset, whose}, pt_counts, [=] MORTISE_HD(const PointTriangle& p) {
    if (!boxes_overlap(swept_box(p.v, 1, 0, s, y, dy, grow), swept_box(p.v + 1, 3, 0, s, y, dy, grow))) return false;
    return s.body[p.v[0]] != s.body[p.v[1]] || !stay_apart(p.v, 1, y, dy, radius);
  });
  mark("broadphase.near_edge_edge", kept.edge_edges, {kept.ee_env_offset, whose}, ee_counts, [=] MORTISE_HD(const EdgeEdge& p) {
    if (!boxes_overlap(swept_box(p.v, 2, 0, s, y, dy, grow), swept_box(p.v + 2, 2, 0, s, y, dy, grow))) return false;
    return s.body[p.v[0]] != s.body[p.v[2]] || !stay_apart(p.v, 2, y, dy, radius);
  });
}

void compact(const NearPairs& kept, const std::vector<std::uint8_t>& whose, const Buffer<Index>& pt_counts, const Buffer<Index>& ee_counts,
             NearPairs& found) {
  compact("broadphase.pick_point_triangle", kept.point_triangles, {kept.pt_env_offset, whose}, pt_counts, found.point_triangles);
  compact("broadphase.pick_edge_edge", kept.edge_edges, {kept.ee_env_offset, whose}, ee_counts, found.edge_edges);
}

void pick(const SurfaceView& surface, const NearPairs& kept, View<const Vec3> y, View<const Vec3> dy, double radius,
          const std::vector<std::uint8_t>& whose, NearPairs& found) {
  Buffer<Index> pt_counts, ee_counts;
  mark_near(surface, kept, y, dy, radius, whose, pt_counts, ee_counts);
  found.add_up({pt_counts, {kept.pt_env_offset, whose}, kept.pt_env_first.view()},
               {ee_counts, {kept.ee_env_offset, whose}, kept.ee_env_first.view()});
  compact(kept, whose, pt_counts, ee_counts, found);
}

// Of the points of every environment.
void farthest(const device::Ranges& whose, View<const Index> point, View<const Vec3> from, View<const Vec3> y, View<const Vec3> dy,
              device::EnvValues out) {
  device::env_max(
      "broadphase.farthest", whose,
      [=] MORTISE_HD(Index i) {
        const Index p = point[i];
        return (from.n > 0 ? (y[p] - from[p]).norm() : 0.0) + (dy.n > 0 ? dy[p].norm() : 0.0) + tuning::kCoordinate * y[p].norm();
      },
      out);
}

void keep(const device::Ranges& whose, View<const Index> point, View<const Vec3> y, View<Vec3> at) {
  device::parallel_for("broadphase.keep", whose, [=] MORTISE_HD(Index i) { at[point[i]] = y[point[i]]; });
}

}  // namespace

Broadphase::Broadphase(const Surface& surface) : surface_(surface), search_(surface), kept_radius_(search_.environments(), -1.0) {
  const std::vector<Index> none(search_.environments() + 1, 0);
  kept_.resize(none, none);
  found_.resize(none, none);
  const std::vector<Index> env = surface.env.download();
  std::vector<Index> points(env.size());
  std::iota(points.begin(), points.end(), 0);
  std::stable_sort(points.begin(), points.end(), [&](Index a, Index b) { return env[a] < env[b]; });
  point_env_.assign(search_.environments() + 1, 0);
  for (Index e : env) ++point_env_[e + 1];
  std::partial_sum(point_env_.begin(), point_env_.end(), point_env_.begin());
  points_.upload(points);
}

void Broadphase::farthest(View<const Vec3> from, View<const Vec3> y, View<const Vec3> dy, const Mask& whose, device::EnvValues out) const {
  out.value.assign(search_.environments(), 0.0);
  geometry::farthest({point_env_, whose}, points_.view(), from, y, dy, out);
}

std::unique_ptr<Broadphase::Guess> Broadphase::guess(View<const Vec3> y, View<const Vec3> dy, double radius, const Mask& whose,
                                                     device::Fetch& fetch) const {
  return ask(y, dy, radius, whose, served_, fetch);
}

std::unique_ptr<Broadphase::Guess> Broadphase::ask(View<const Vec3> y, View<const Vec3> dy, double radius, const Mask& whose, bool serves,
                                                   device::Fetch& fetch) const {
  auto out = std::make_unique<Guess>();
  out->whose = whose, out->radius = radius, out->list = list_, out->answers = serves;
  Mask asked(search_.environments(), 0), kept(asked);
  for (std::size_t e = 0; e < asked.size(); ++e) {
    asked[e] = whose.empty() || whose[e], kept[e] = asked[e] && kept_radius_[e] >= radius;
    out->answers = out->answers && kept[e] == asked[e];
  }
  out->off.assign(asked.size(), 0.0);
  if (any(kept)) farthest(kept_at_.view(), y, dy, kept, {out->off, fetch});
  farthest({}, y, dy, asked, {out->way, fetch});
  if (!out->answers) return out;
  mark_near(surface_.view(), kept_, y, dy, radius, whose, out->pt_counts, out->ee_counts);
  out->sizes.begin_add_up({out->pt_counts, {kept_.pt_env_offset, whose}, kept_.pt_env_first.view()},
                          {out->ee_counts, {kept_.ee_env_offset, whose}, kept_.ee_env_first.view()}, out->sums, fetch);
  out->pairs = {{kept_.point_triangles.view(), std::as_const(out->pt_counts).view()},
                {kept_.edge_edges.view(), std::as_const(out->ee_counts).view()},
                {kept_.pt_env_offset, whose},
                {kept_.ee_env_offset, whose}};
  return out;
}

bool Broadphase::take(Guess& guess) {
  if (!guess.answers || guess.list != list_) return false;
  for (std::size_t e = 0; e < guess.off.size(); ++e)
    if ((guess.whose.empty() || guess.whose[e]) && !serves(guess.radius, guess.off[e], static_cast<Index>(e))) return false;
  found_.take_sizes(guess.sizes);
  found_.end_add_up(guess.sums);
  compact(kept_, guess.whose, guess.pt_counts, guess.ee_counts, found_);
  return true;
}

void Broadphase::update(View<const Vec3> y, View<const Vec3> dy, double radius, const Mask& whose) {
  device::Fetch fetch;
  const std::unique_ptr<Guess> guess = this->guess(y, dy, radius, whose, fetch);
  fetch.now("kept pairs");
  if (take(*guess)) return;
  const std::unique_ptr<Guess> found = search(y, dy, *guess, {}, fetch);
  fetch.now("pairs");
  if (found) take(*found);
}

std::unique_ptr<Broadphase::Guess> Broadphase::search(View<const Vec3> y, View<const Vec3> dy, const Guess& refused, const Shorten& shorten,
                                                      device::Fetch& fetch) {
  const Index envs = search_.environments();
  const double radius = refused.radius;
  const Mask& whose = refused.whose;
  std::unique_ptr<Guess> again;  // where somebody else has searched since
  if (refused.list != list_) {
    device::Fetch now;
    again = ask(y, dy, radius, whose, false, now);
    now.now("way of points");
  }
  const std::vector<double>&off = again ? again->off : refused.off, &way = again ? again->way : refused.way;
  Mask asked(envs, 0), stale(envs, 0), direct(envs, 0);  // direct: searched without anything that could be kept
  for (Index e = 0; e < envs; ++e) asked[e] = whose.empty() || whose[e];
  for (Index e = 0; e < envs; ++e) stale[e] = asked[e] && !serves(radius, off[e], e);
  served_ = !any(stale);
  std::vector<double> wider(envs, radius);
  for (Index e = 0; e < envs; ++e) {
    if (!stale[e]) continue;
    ++searches_;
    const double more = tuning::kSurplus * way[e];
    direct[e] = dy.n == 0 || !(more <= most_surplus(y));
    stale[e] = !direct[e];
    if (stale[e]) wider[e] = radius + more;
  }
  if (any(stale)) keep_more(y, wider, stale);
  if (!any(direct)) return ask(y, dy, radius, whose, true, fetch);
  Mask rest(envs, 0);
  for (Index e = 0; e < envs; ++e) rest[e] = asked[e] && !direct[e];
  if (any(rest)) {
    NearPairs swept, picked;
    find_on_ways(y, dy, radius, direct, way, shorten, swept);
    pick(surface_.view(), kept_, y, dy, radius, rest, picked);
    join(surface_.view(), picked, swept, direct, found_);
  } else {
    find_on_ways(y, dy, radius, direct, way, shorten, found_);
  }
  return nullptr;
}

void Broadphase::find_on_ways(View<const Vec3> y, View<const Vec3> dy, double radius, const Mask& whose, const std::vector<double>& way,
                              const Shorten& shorten, NearPairs& to) {
  const std::vector<double> same(search_.environments(), radius);
  std::vector<double> size;  // of environments [m]
  for (int time = 0;; ++time) {
    const NearPairs::Sums& pairs = search_.count(y, dy, same, whose, to);
    if (!shorten || time == tuning::kShortenings) break;
    std::vector<double> by(search_.environments(), 1.0);
    bool too_many = false;
    for (std::size_t e = 0; e < by.size(); ++e) {
      if (!whose[e] || !(pairs.of(e) > std::max(tuning::kFewPairs, tuning::kPairsEach * search_.queries(static_cast<Index>(e))))) continue;
      if (size.empty()) size = sizes(y);
      by[e] = time == 0 ? std::min(0.5, size[e] / way[e]) : 0.5, too_many = true;
    }
    if (!too_many) break;
    shorten(by);
  }
  search_.fill(y, dy, to);
}

// Diagonals of the boxes around all points of every environment [m].
std::vector<double> Broadphase::sizes(View<const Vec3> y) const {
  std::vector<Vec3> at(y.n);
  device::copy_out(at.data(), y.p, at.size() * sizeof(Vec3));
  const std::vector<Index> points = points_.download();
  std::vector<double> out;
  for (Index e = 0; e < search_.environments(); ++e) {
    Bounds box;
    for (Index i = point_env_[e]; i < point_env_[e + 1]; ++i) box.include(at[points[i]]);
    out.push_back(box.size().norm());
  }
  return out;
}

// Keeps what is found at y of the environments of `whose`, and of the others what was kept.
void Broadphase::keep_more(View<const Vec3> y, const std::vector<double>& radius, const Mask& whose) {
  if (all(whose)) {
    search_.find(y, {}, radius, whose, kept_);
  } else {
    NearPairs fresh, joined;
    search_.find(y, {}, radius, whose, fresh);
    join(surface_.view(), kept_, fresh, whose, joined);
    kept_ = std::move(joined);
  }
  if (kept_at_.size() != y.n) kept_at_.resize(y.n);
  keep({point_env_, whose}, std::as_const(points_).view(), y, kept_at_.view());
  for (std::size_t e = 0; e < whose.size(); ++e)
    if (whose[e]) kept_radius_[e] = radius[e];
  ++list_;
}

void Broadphase::copy(const Mask& whose, NearPairs& to) const {
  const Index envs = search_.environments();
  if (to.pt_env_offset.empty()) to.resize(std::vector<Index>(envs + 1, 0), std::vector<Index>(envs + 1, 0));
  if (whose.empty() || all(whose)) return to.copy_from(found_);
  NearPairs joined;
  join(surface_.view(), to, found_, whose, joined);
  to = std::move(joined);
}

double Broadphase::most_surplus(View<const Vec3> y) {
  if (most_surplus_ >= 0) return most_surplus_;
  std::vector<double> length(surface_.pairs.bodies(), 0.0), count(surface_.pairs.bodies(), 0.0);
  const std::vector<Index> body = surface_.body.download();
  std::vector<Vec3> at(y.n);
  device::copy_out(at.data(), y.p, at.size() * sizeof(Vec3));
  for (const Edge& e : surface_.edges.download()) length[body[e.v[0]]] += (at[e.v[0]] - at[e.v[1]]).norm(), count[body[e.v[0]]] += 1;
  double finest = INFINITY;
  for (Index b = 0; b < surface_.pairs.bodies(); ++b)
    if (count[b] > 0) finest = std::min(finest, length[b] / count[b]);
  return most_surplus_ = std::isfinite(finest) ? tuning::kLargestSurplus * finest : 0;
}

}  // namespace mortise::geometry
