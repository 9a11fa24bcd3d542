#include "effects/contact/prescribed.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

#include "device/one_of.h"
#include "effects/contact/tuning.h"
#include "effects/failure.h"
#include "geometry/collide/ccd.h"

namespace mortise::effects::contact {

// The earliest of all, the first in canonical order.
struct Earliest {
  double t = 2;  // of the step; above 1: never
  Index pair = -1;
};

// When every pair of one kind meets; the earliest is known once the fetch is done.
struct MeetingTimes {
  Buffer<double> times;
  std::vector<double> first{-2.0};  // minus the earliest time

  void find_first(device::Fetch& fetch) {
    const View<const double> t = std::as_const(times).view();
    device::env_max(
        "contact.earliest", {0, t.n}, [=] MORTISE_HD(Index i) { return -t[i]; }, device::EnvValues{first, fetch});
  }
  Earliest earliest() const {
    if (!(-first[0] <= 1)) return {};
    const std::vector<double> all = times.download();
    const auto least = std::min_element(all.begin(), all.end());
    return {*least, static_cast<Index>(least - all.begin())};
  }
};

namespace {

template <class Pair>
void meeting(const char* name, const BarrierView& s, const geometry::Chosen<Pair>& chosen, bool edges, View<const std::uint8_t> held,
             View<const Vec3> y, View<const Vec3> dy, MeetingTimes& found) {
  const geometry::Chosen<Pair> list = chosen;
  const View<const Pair> pairs = list.pair;
  found.times.resize(pairs.n);
  const View<double> out = found.times.view();
  device::parallel_for(name, pairs.n, [=] MORTISE_HD(Index i) {
    out[i] = geometry::kNoImpact;
    if (!list.has(i)) return;
    Vec3 x0[4], x1[4];
    bool all = s.sees(pairs[i].v[0], pairs[i].v[edges ? 2 : 1]);
    for (int k = 0; k < 4; ++k) {
      const Index p = pairs[i].v[k];
      all = all && held[p];
      x0[k] = y[p], x1[k] = y[p] + dy[p];
    }
    if (all) out[i] = geometry::detail::step_limit(x0, x1, edges, tuning::kTouch);
  });
}

void plane_meeting(const BarrierView& s, View<const std::uint8_t> held, View<const Vec3> y, View<const Vec3> dy, MeetingTimes& found) {
  const Index n = s.planes.n * s.surface.vertices.n;
  found.times.resize(n);
  const View<double> out = found.times.view();
  device::parallel_for("contact.plane_meeting", n, [=] MORTISE_HD(Index i) {
    const Index plane = i / s.surface.vertices.n, p = s.surface.vertices[i % s.surface.vertices.n];
    out[i] = geometry::kNoImpact;
    if (!held[p] || !s.sees_plane(p, plane)) return;
    const double gap = s.planes[plane].normal.dot(y[p] - s.planes[plane].point), way = -s.planes[plane].normal.dot(dy[p]);
    if (way > (1 - tuning::kTouch) * gap) out[i] = gap / way;
  });
}

Vec3 at(View<const Vec3> y, View<const Vec3> dy, Index p, double t) { return device::one_of(y, p) + t * device::one_of(dy, p); }

[[noreturn]] void fail(const model::Body& first, const std::string& b, double t, const Vec3& x, const StepInfo& step) {
  const std::string& a = first.name;
  char when[200];
  std::snprintf(when, sizeof when, "at %s%.6g%s near (%.4g, %.4g, %.4g) m",
                step.is_static ? "pseudo-time " : "t = ", step.t0_of(first.env) + t * step.dt, step.is_static ? "" : " s", x[0], x[1], x[2]);
  const std::string who = a == b ? "two parts of '" + a + "' meet " : "'" + a + "' meets '" + b + "' ";
  const std::string how = a == b ? "" : "; if they are to pass through each other, say so: pairs: [{bodies: [" + a + ", " + b + "], collide: false}]";
  throw Failure{who + when + "; supports prescribe the motion of both, so neither can give way" + how, first.env};
}

}  // namespace

// And all that a message about a meeting needs.
struct Prescribed::Meetings {
  MeetingTimes of_planes, of_points, of_edges;
  Buffer<Vec3> y, dy;

  void keep(View<const Vec3> from, View<const Vec3> way) {
    y.resize(from.n), dy.resize(way.n);
    device::copy(y.view().p, from.p, from.n * sizeof(Vec3));
    device::copy(dy.view().p, way.p, way.n * sizeof(Vec3));
  }
  Vec3 place(Index p, double t) const { return at(y.view(), dy.view(), p, t); }
};

void Prescribed::check(const Meetings& found, const BarrierView& s, const geometry::ChosenPairs& near, const StepInfo& step) const {
  const Earliest plane = found.of_planes.earliest(), points = found.of_points.earliest(), edges = found.of_edges.earliest();
  const auto body = [&](Index p) -> const model::Body& { return model_.bodies[device::one_of(s.surface.body, p)]; };
  if (plane.t <= 1 && plane.t <= std::min(points.t, edges.t)) {
    const Index p = device::one_of(s.surface.vertices, plane.pair % s.surface.vertices.n);
    fail(body(p), model_.half_spaces[plane.pair / s.surface.vertices.n].name, plane.t, found.place(p, plane.t), step);
  }
  if (points.t <= 1 && points.t <= edges.t) {
    const geometry::PointTriangle pair = device::one_of(near.points.pair, points.pair);
    fail(body(pair.v[0]), body(pair.v[1]).name, points.t, found.place(pair.v[0], points.t), step);
  }
  if (edges.t <= 1) {
    const geometry::EdgeEdge pair = device::one_of(near.edges.pair, edges.pair);
    Vec3 x[4];
    for (int k = 0; k < 4; ++k) x[k] = found.place(pair.v[k], edges.t);
    const geometry::Closest c = geometry::closest_edge_edge(x);
    fail(body(pair.v[0]), body(pair.v[2]).name, edges.t, c.w[0] * x[0] + c.w[1] * x[1], step);
  }
}

void Prescribed::refresh() {
  if (model_.held == held_) return;
  held_ = model_.held;
  const std::vector<Index> offset = model_.point_offset.download(), block = model_.point_block.download();
  std::vector<std::uint8_t> point(model_.points, 0);
  for (Index p = 0; p < model_.points; ++p)
    point[p] = std::all_of(block.begin() + offset[p], block.begin() + offset[p + 1], [&](Index b) { return model_.ties.held(b, held_); });
  point_.upload(point);
}

std::shared_ptr<const Prescribed::Meetings> Prescribed::look(const BarrierView& s, const geometry::ChosenPairs& near, View<const Vec3> y,
                                                             View<const Vec3> dy, device::Fetch& fetch) {
  if (!model_.driven) return nullptr;
  refresh();
  const View<const std::uint8_t> held = std::as_const(point_).view();
  auto found = std::make_shared<Meetings>();
  plane_meeting(s, held, y, dy, found->of_planes);
  meeting("contact.points_meeting", s, near.points, false, held, y, dy, found->of_points);
  meeting("contact.edges_meeting", s, near.edges, true, held, y, dy, found->of_edges);
  found->keep(y, dy);
  for (MeetingTimes* m : {&found->of_planes, &found->of_points, &found->of_edges}) m->find_first(fetch);
  return found;
}

}  // namespace mortise::effects::contact
