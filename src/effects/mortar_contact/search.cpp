#include <utility>

#include "effects/mortar_contact/frozen.h"

namespace mortise::effects::mortar {
namespace {

// Has the triangle one of these points? Any has where there are none.
MORTISE_HD inline bool has_one(const Triangle& t, View<const std::uint8_t> points) {
  return points.n == 0 || points[t.v[0]] || points[t.v[1]] || points[t.v[2]];
}

// How far slave i sees; for points, no farther beyond its support than it is long.
MORTISE_HD inline double reach_of(const MortarView& s, View<const Vec3> y, Index i, View<const double> margin, View<const std::uint8_t> points) {
  const Triangle t = s.surface.triangles[s.slaves[i]];
  double beyond = margin[s.surface.env[t.v[0]]], longest = 0;
  for (int k = 0; k < 3 && points.n > 0; ++k) longest = std::fmax(longest, (y[t.v[(k + 1) % 3]] - y[t.v[k]]).norm());
  if (points.n > 0) beyond = std::fmin(beyond, longest);
  return s.support[i] + beyond + s.bow_of(s.slaves[i]);
}

// Counts the masters near a slave; writes them unless out is null.
MORTISE_HD inline Index masters_near(const MortarView& s, const geometry::BvhView& tree, View<const Index> masters, View<const Vec3> y, Index slave,
                                     double reach, View<const std::uint8_t> points, Index* out) {
  const Triangle t = s.surface.triangles[slave];
  const bool any = has_one(t, points);
  const geometry::BvhNode box = geometry::swept_box(t.v, 3, -1, s.surface, y, View<const Vec3>{}, tuning::kBeside * reach);
  geometry::BvhCursor cursor;
  Index n = 0;
  for (Index row = cursor.next(tree, box, s.surface); row >= 0; row = cursor.next(tree, box, s.surface)) {
    const Index m = masters[row];
    if (!any && !has_one(s.surface.triangles[m], points)) continue;
    if (out) {
      Index at = n;  // ascending: the order of the leaves must not show
      for (; at > 0 && out[at - 1] > m; --at) out[at] = out[at - 1];
      out[at] = m;
    }
    ++n;
  }
  for (Index p = 0; any && p < s.planes.n; ++p) {
    if (s.interface_at(s.surface.body[t.v[0]], s.surface.pairs.bodies + p) < 0) continue;
    double least = INFINITY;
    for (int k = 0; k < 3; ++k) least = std::fmin(least, s.planes[p].normal.dot(y[t.v[k]] - s.planes[p].point));
    if (!(least < reach)) continue;
    if (out) out[n] = -1 - p;
    ++n;
  }
  return n;
}

}  // namespace

Search::Search(std::vector<Index> slave_env, const std::vector<Index>& masters, std::vector<Index> master_env, const std::vector<Triangle>& triangles)
    : slave_env_(std::move(slave_env)), master_env_(std::move(master_env)) {
  std::vector<Triangle> corners;
  for (Index m : masters) corners.push_back(triangles[m]);
  masters_.upload(masters);
  corners_.upload(corners);
}

void Search::count(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, View<const std::uint8_t> points) {
  const View<const Index> masters = std::as_const(masters_).view();
  const View<const Triangle> corners = std::as_const(corners_).view();
  const View<const double> bow = s.bow;
  bow_.resize(bow.n > 0 ? masters.n : 0);
  const View<double> of_masters = bow_.view();
  device::parallel_for("mortar_contact.bows", of_masters.n, [=] MORTISE_HD(Index i) { of_masters[i] = bow[masters[i]]; });
  const device::Ranges slaves(slave_env_, whose_), seen(master_env_, whose_);
  tree_.update({corners.n ? corners.p->v : nullptr, corners.n, 3}, s.surface, slaves.environments(), y, {}, {.own = std::as_const(bow_).view()},
               &seen);
  const geometry::BvhView tree = tree_.view();
  const View<const double> extra = margin.view();
  offset_.resize(s.slaves.n + 1);
  if (slaves.size() < s.slaves.n) offset_.zero();
  const View<Index> count = offset_.view();
  const MortarView view = s;
  device::parallel_for("mortar_contact.count_masters", slaves, [=] MORTISE_HD(Index i) {
    count[i] = masters_near(view, tree, masters, y, view.slaves[i], reach_of(view, y, i, extra, points), points, nullptr);
  });
  device::scan(offset_);
}

// The first `room` of them. Slaves that do not find room for all of theirs have none.
void Search::list(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, Index room, View<const std::uint8_t> points) {
  const View<const Index> masters = std::as_const(masters_).view(), first = std::as_const(offset_).view();
  const View<const double> extra = margin.view();
  const geometry::BvhView tree = tree_.view();
  const MortarView view = s;
  slave_.resize(room), master_.resize(room);
  const View<Index> slave = slave_.view(), master = master_.view();
  device::parallel_for("mortar_contact.find_masters", s.slaves.n + room, [=] MORTISE_HD(Index i) {
    const Index slaves = view.slaves.n;
    if (i >= slaves) {
      const Index c = i - slaves;
      if (c >= first[slaves]) slave[c] = 0, master[c] = kNobody;
      return;
    }
    if (first[i + 1] == first[i]) return;
    if (first[i + 1] > room) {
      for (Index c = first[i]; c < room; ++c) slave[c] = i, master[c] = kNobody;
      return;
    }
    for (Index c = first[i]; c < first[i + 1]; ++c) slave[c] = i;
    masters_near(view, tree, masters, y, view.slaves[i], reach_of(view, y, i, extra, points), points, master.p + first[i]);
  });
}

void Search::begin(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, Index room, device::Fetch& fetch) {
  count(s, y, margin, {});
  fetch.add_total(offset_, found_);
  list(s, y, margin, room, {});
}

bool Search::end() {
  if (found_ > master_.size()) return false;
  slave_.resize(found_), master_.resize(found_);
  return true;
}

void Search::update(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, View<const std::uint8_t> points) {
  count(s, y, margin, points);
  device::Fetch fetch;
  fetch.add_total(offset_, found_);
  fetch.now("masters");
  list(s, y, margin, found_, points);
}

}  // namespace mortise::effects::mortar
