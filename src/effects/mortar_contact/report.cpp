#include "effects/contact/report.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "effects/contact/nodal_pressure.h"
#include "effects/contact/start_check.h"
#include "effects/mortar_contact/mortar_contact.h"
#include "effects/per_environment.h"

namespace mortise::effects::mortar {
namespace {

// What the samples of an environment, and its pairs of the guard, come to.
struct Sums {
  contact::SampleRows rows, guard_rows;
  std::vector<double> kind;
  double total[kKinds + 1] = {};  // [N], by kind, then the guard
  double closest;                 // [m]
};

// Forces of samples, on points and by environment.
struct Tally {
  contact::PointForces forces;
  // What hat functions make of the pressures [N]: on quadratic faces those of their quarters, whose shares are nowhere negative.
  std::vector<double> load;
  std::vector<double> covered;  // [m^2]
  std::vector<Sums> sums;

  void press(Index point, const Vec3& force) { Eigen::Map<Vec3>(load.data() + 3 * point) += force; }
  void add(Index point, const Vec3& force, const model::ContactSample& c) {
    forces.add(point, force, forces.body(point) == c.body_a ? c.body_b : c.body_a);
  }

  // least: what counts as the distance of curved faces, which may meet between their nodes; kept apart are their quarters [m].
  void add(const Pair& pair, const Sample& s, const model::ContactSample& c, double least) {
    Vec3 J[kPoints];
    jacobian(pair, s, J);
    for (int k = 0; k < points_of(pair); ++k) add(point_of(pair, k), c.pressure * c.area * J[k], c);
    const Vec3 on_master = c.pressure * c.area * Vec3(c.normal[0], c.normal[1], c.normal[2]);
    for (int k = 0; k < 3; ++k) {
      const Index on = pair.on.point[pair.on.vertex(k)], under = pair.master < 0 ? -1 : pair.under.point[pair.under.vertex(k)];
      press(on, (under < 0 ? s.N[k] : -s.N[k]) * on_master);  // a half-space's normal points at the slave
      if (under >= 0) press(under, s.M[k] * on_master);
      if (s.kind == SampleKind::face) continue;
      covered[on] += s.N[k] * c.area;
      if (under >= 0) covered[under] += s.M[k] * c.area;
    }
    Sums& mine = sums[c.env];
    mine.total[static_cast<Index>(s.kind)] += c.force;
    mine.closest = std::min(mine.closest, pair.quadratic() ? std::max(c.gap, least) : c.gap);
    mine.rows.add(c);
    mine.kind.push_back(static_cast<double>(s.kind));
  }
  // force: on each of its points.
  void add(const contact::Active& term, const Vec3* force, const model::ContactSample& c) {
    Sums& mine = sums[c.env];
    mine.total[kKinds] += force[0].norm();
    for (int k = 0; k < 4; ++k)
      if (const Index p = term.point[k]; p >= 0) add(p, force[k], c), press(p, force[k]);
    mine.guard_rows.add(c);
  }
};

void report_shares(FieldSink& sink, const std::string& group, const double (&total)[kKinds + 1]) {
  const char* const names[] = {"force_share_faces", "force_share_edges", "force_share_points", "force_share_guard"};
  double sum = 0;
  for (double t : total) sum += t;
  for (int k = 0; k <= kKinds; ++k) sink.scalar(group, names[k], "1", sum > 0 ? total[k] / sum : 0);
}

// Those that samples of the pair press.
void mark(const Pair& pair, std::vector<std::uint8_t>& points) {
  for (int k = 0; k < 3; ++k) {
    points[pair.on.point[pair.on.vertex(k)]] = 1;
    if (pair.master >= 0) points[pair.under.point[pair.under.vertex(k)]] = 1;
  }
}

// Of slaves whose pieces add up to their area but for rounding: how far they are from it. Stacked layers count more than once.
double partition_defect(std::span<const double> share) {
  double defect = 0;
  for (double s : share)
    if (std::abs(s - 1) < tuning::kWhole) defect = std::max(defect, std::abs(s - 1));
  return defect;
}

}  // namespace

// Areas over or under the other surface, of points on which a force is (of others parts): of a point of slaves and masters the larger [m^2]. What is
// farther than a slave's longest edge, or than that of the longest one in contact, is not over it. share: what of every triangle with such a point is
// covered by triangles.
std::vector<double> MortarContact::cover_of(const MortarLinearisation& at, const std::vector<Vec3>& y, const std::vector<Pair>& pairs,
                                            const std::vector<std::uint8_t>& pressed, std::vector<double>& share) {
  std::vector<double> reach = more_reach();
  for (const Pair& p : pairs)
    for (int k = 0; k < 3; ++k) {
      const Index a = p.on.point[p.on.vertex(k)], b = p.on.point[p.on.vertex((k + 1) % 3)];
      reach[p.env] = std::max(reach[p.env], (y[a] - y[b]).norm());
    }
  Buffer<double> wide;
  wide.upload(reach);
  Buffer<std::uint8_t> points;
  points.upload(pressed);
  surfaces_.search().work_on(model_.at_work);
  surfaces_.search().update(view(at), at.y(), wide, std::as_const(points).view());
  Buffer<Cover> buffer;
  cover(view(at), surfaces_.search(), at.y(), buffer);
  const std::vector<Triangle> triangles = model_.surface.triangles.download();
  std::vector<double> on(model_.points, 0.0), under(model_.points, 0.0);
  share.assign(triangles.size(), 0.0);
  for (const Cover& c : buffer.download()) {
    const Index* v = triangles[c.slave].v;
    if (c.master >= 0 && std::any_of(v, v + 3, [&](Index i) { return pressed[i]; })) share[c.slave] += c.share;
    for (int k = 0; k < 3; ++k) {
      on[v[k]] += c.N[k];
      if (c.master >= 0) under[triangles[c.master].v[k]] += c.M[k];
    }
  }
  for (std::size_t i = 0; i < on.size(); ++i) on[i] = std::max(on[i], under[i]);
  return on;
}

void MortarContact::report(const FieldSinks& sinks, const Linearisation& accepted) {
  const MortarLinearisation& at = of_mortar(accepted);
  const Taken taken(at.frozen);
  const std::vector<model::ContactSample> published = at.contact.samples.download();
  const std::string group(name());
  Tally tally{{model_, at.frozen.y}, std::vector<double>(3 * static_cast<std::size_t>(model_.points), 0.0), {}, {}};
  for (Index e = 0; e < model_.envs; ++e) tally.sums.push_back({{model_, e}, {model_, e}, {}, {}, d_hat_[e]});
  const auto sample = [&](std::size_t i) { return published.at(at.place(taken.pairs[taken.samples[i].pair].env, static_cast<Index>(i))); };
  const std::vector<contact::Active> terms = guard_ > 0 ? at.guard.terms.download() : std::vector<contact::Active>();
  std::vector<std::uint8_t> pressed(model_.points, 0);
  for (std::size_t i = 0; i < taken.samples.size(); ++i)
    if (sample(i).pressure > 0) mark(taken.pairs[taken.samples[i].pair], pressed);
  for (const contact::Active& term : terms)
    for (const Index p : term.point)
      if (p >= 0) pressed[p] = 1;
  std::vector<double> share;
  tally.covered = cover_of(at, tally.forces.places(), taken.pairs, pressed, share);

  for (std::size_t i = 0; i < taken.samples.size(); ++i) {
    const Pair& pair = taken.pairs[taken.samples[i].pair];
    tally.add(pair, taken.samples[i], sample(i), proximity_.reach(pair.env));
  }
  if (guard_ > 0) {
    Buffer<Vec3> buffer;
    contact::point_forces(guard_view(), at.guard, at.y(), buffer);
    const std::vector<Vec3> force = buffer.download();
    for (std::size_t i = 0; i < terms.size(); ++i)
      tally.add(terms[i], force.data() + 4 * i, published.at(at.guard_place(terms[i].env, static_cast<Index>(i))));
    for (Index e = 0; e < sinks.size(); ++e) tally.sums[e].guard_rows.report(sinks[e], group, "guard_");
  }
  tally.forces.report(sinks, group);
  const contact::NodalPressure nodal = contact::nodal_pressure(model_.surface, tally.forces.places(), tally.load, tally.covered);
  report_points(sinks, model_, "contact_pressure", "Pa", 1, nodal.pressure);
  report_points(sinks, model_, "contact_area", "m^2", 1, nodal.area);

  const std::vector<double> distance = contact::least_distances(proximity_.obstacles(guard_view()), proximity_.candidates(at.frozen.y), at.y(),
                                                                proximity_.vertex_env()),
                            energy = energies_now(std::as_const(model_.q).view(), at, model_.envs);
  const std::vector<Index>& first = surfaces_.triangle_env();
  for (Index e = 0; e < sinks.size(); ++e) {
    if (!sinks.wanted(e)) continue;
    FieldSink& sink = sinks[e];
    const Sums& mine = tally.sums[e];
    mine.rows.report(sink, group);
    sink.scalar(group, "pressure_sum_defect", "1", contact::sum_defect(tally.forces, {&mine.rows, &mine.guard_rows}));
    sink.rows(group, "kind", "1", 1, mine.kind);
    sink.scalar(group, "min_distance", "m", distance[e] < proximity_.reach(e) ? std::min(mine.closest, distance[e]) : mine.closest);
    // The stiffness that the next step begins with was paid for by this one.
    sink.scalar(group, "energy", "J", energy[e] + stiffnesses_.price(e));
    sink.scalar(group, "active_pairs", "1", static_cast<double>(at.frozen.env_pairs[e + 1] - at.frozen.env_pairs[e]));
    report_shares(sink, group, mine.total);
    sink.scalar(group, "clip_partition_defect", "1", partition_defect(std::span(share).subspan(first[e], first[e + 1] - first[e])));
  }
  const std::vector<Interface>& interfaces = surfaces_.interfaces();
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const std::string pair = surfaces_.name_of(interfaces[i].slave) + "_" + surfaces_.name_of(interfaces[i].master);
    FieldSink& sink = sinks[interfaces[i].env];
    sink.scalar(group, "stiffness_" + pair, "Pa", stiffnesses_.kappa(i));
    sink.scalar(group, "k_" + pair, "1", achieved(interfaces[i], static_cast<Index>(i), stiffnesses_.kappa(i), taken).k);
  }
}

}  // namespace mortise::effects::mortar
