#include "effects/contact/active.h"
#include "model/expand.h"

namespace mortise::effects::contact {
namespace {

using model::ContactSample;

MORTISE_HD inline Index points_of(TermKind kind) {
  return kind == TermKind::plane ? 1 : kind == TermKind::vertex ? 2 : kind == TermKind::edge ? 3 : 4;
}

// A term as four points and the closest points between them. Unused points stand at the first one.
MORTISE_HD inline Closest closest(const Active& a, View<const Vec3> y, Vec3 x[4]) {
  gather(y, a.point, x);
  switch (a.kind) {
    case TermKind::triangle:
      return geometry::closest_point_triangle(x);
    case TermKind::edge:
      return closest_on_segment(x, 1, 2);
    case TermKind::edge_edge:
      return geometry::closest_edge_edge(x);
    default:
      break;
  }
  Closest c;
  c.w[0] = 1, c.w[1] = -1;
  c.squared = (x[0] - x[1]).squaredNorm();
  return c;
}
MORTISE_HD inline double range_of(const BarrierView& s, const Active& a) {
  return a.kind == TermKind::edge_edge ? edge_range(s, a.point) : point_range(s, a.point[0], a.point[1]);
}

struct NoHessian {
  MORTISE_HD void operator()(double, const Vec3*) const {}
};

// Gradient per point.
template <class Add>
MORTISE_HD inline void differentiate(const BarrierView& s, const Active& a, View<const Vec3> y, bool hessian, Vec3 grad[4], Add& add) {
  if (a.kind == TermKind::plane) {
    const Plane p = s.planes[a.plane];
    const double g = p.normal.dot(y[a.point[0]] - p.point), k = s.kappa(a.point[0]) * a.weight;
    grad[0] = k * barrier::first(g, s.d_hat(a.point[0])) * p.normal;
    if (hessian) {
      const Vec3 v[4] = {p.normal, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      add(k * barrier::second(g, s.d_hat(a.point[0])), v);
    }
    return;
  }
  Vec3 x[4];
  Frame f;
  const Closest c = closest(a, y, x);
  evaluate(c, x, range_of(s, a), s.kappa(a.point[0]) * a.weight, a.eps, hessian, f, grad, add);
}

// Adds rank-one terms to the Hessian of a stencil: the positive ones, and a share of the negative ones.
struct AddTerms {
  const model::Expansion<4>& e;
  const linalg::StencilView& out;
  Index stencil;
  double concave;  // of its environment
  MORTISE_HD void operator()(double c, const Vec3* v) const {
    if (c < 0) c *= concave;
    if (c == 0) return;
    Vec3 V[16];
    e.chain(v, V);
    model::add_rank_one(out, stencil, e.blocks, c, V);
  }
};

MORTISE_HD inline ContactSample sample_of(const BarrierView& s, const Active& a, View<const Vec3> y) {
  ContactSample out;
  for (Index k = 0; k < model::kSamplePoints; ++k) out.point[k] = -1, out.weight[k] = 0;
  out.points = points_of(a.kind);
  for (Index k = 0; k < out.points; ++k) out.point[k] = a.point[k];
  out.env = a.env;
  out.body_a = s.surface.body[a.point[0]];
  const double k = s.kappa(a.point[0]) * a.weight;
  Vec3 n, place;
  if (a.kind == TermKind::plane) {
    const Plane p = s.planes[a.plane];
    n = p.normal;
    out.gap = n.dot(y[a.point[0]] - p.point);
    out.weight[0] = 1;
    out.force = -k * barrier::first(out.gap, s.d_hat(a.point[0]));
    out.stiffness = k * barrier::second(out.gap, s.d_hat(a.point[0]));
    out.body_b = s.surface.pairs.bodies + a.plane;
    place = y[a.point[0]] - out.gap / 2 * n;
  } else {
    Vec3 x[4];
    const Closest c = closest(a, y, x);
    const Frame f = frame(c, x);
    n = -f.n;  // from the first primitive to the second
    out.gap = f.d;
    place = Vec3::Zero();
    for (Index j = 0; j < out.points; ++j) out.weight[j] = -f.w[j];
    for (Index j = 0; j < 4; ++j) place += std::abs(f.w[j]) / 2 * x[j];
    const double m = a.eps > 0 ? geometry::mollifier(x, a.eps) : 1;
    out.force = -k * m * barrier::first(f.d, range_of(s, a));
    out.stiffness = k * m * barrier::second(f.d, range_of(s, a));
    out.body_b = s.surface.body[a.point[a.kind == TermKind::edge_edge ? 2 : 1]];
  }
  out.area = s.barrier.area_weighted && a.kind != TermKind::edge_edge ? a.weight : 0;
  out.pressure = out.area != 0 ? out.force / out.area : 0;
  for (int i = 0; i < 3; ++i) out.normal[i] = n[i], out.position[i] = place[i];
  return out;
}

inline constexpr Index kFunctionals = 6;  // of a sample, at most: of its gap, two tangents, two turns and the mollifier

// Weights, normal and force of sample_of() as functions of the points. With the frame of stencil.h, r = sum_i w_i x_i = d n, the closest points go on
// by dtau_j along the tangents t_j that have a parameter, so that r stays across them:
//     dtau_j = -(t_j . sum w dx + d n . sum u_j dx),     dw_i = sum_j u_ji dtau_j,     dd = n . sum w dx,
//     dn     = -sum_j t_j (n . sum u_j dx) + sum_free t (t . sum w dx)/d,              d force = -k (m b'' dd + b' dm).
MORTISE_HD inline void change(const BarrierView& s, const Active& a, View<const Vec3> y, const model::SampleChangesView& out, Index at) {
  for (Index c = 0; c < kFunctionals; ++c) out.clear(at, c);
  const double k = s.kappa(a.point[0]) * a.weight;
  if (a.kind == TermKind::plane) {
    const Plane p = s.planes[a.plane];
    out.along(at, 0)[0] = p.normal;
    out.force(at, 0) = -k * barrier::second(p.normal.dot(y[a.point[0]] - p.point), s.d_hat(a.point[0]));
    return;
  }
  Vec3 x[4];
  const Frame f = frame(closest(a, y, x), x);
  const double d_hat = range_of(s, a), b1 = barrier::first(f.d, d_hat);
  Mollifier m;
  if (a.eps > 0) m = mollifier(x, a.eps);
  for (int i = 0; i < 4; ++i) out.along(at, 0)[i] = f.w[i] * f.n;
  out.force(at, 0) = -k * m.m * barrier::second(f.d, d_hat);
  // Samples count weights and normal the other way round: from the first primitive to the second.
  for (int j = 0; j < 2; ++j) {
    const bool free = j >= f.free;
    for (int i = 0; i < 4; ++i) {
      out.along(at, 1 + j)[i] = f.w[i] * f.t[j];
      if (free) continue;
      out.along(at, 3 + j)[i] = f.u[j][i] * f.n;
      out.weight(at, 1 + j)[i] = f.u[j][i];
      out.weight(at, 3 + j)[i] = f.d * f.u[j][i];
    }
    if (free)
      out.normal(at, 1 + j) = -f.t[j] / f.d;
    else
      out.normal(at, 3 + j) = f.t[j];
  }
  if (m.m1 > 0) {
    const Index c = 3 + f.free;
    spread(2 * m.v.cross(m.X), 2 * m.X.cross(m.u), out.along(at, c));
    out.force(at, c) = -k * m.m1 * b1;
  }
}

}  // namespace

void face_planes(const BarrierView& s, View<const Vec3> y, View<double> plane_area) {
  const Index n = s.surface.vertices.n;
  device::parallel_for("contact.face_planes", plane_area.n,
                       [=] MORTISE_HD(Index i) { plane_area[i] = facing_area(s, s.surface.vertices[i % n], s.planes[i / n].normal, y); });
}

void face_points(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, View<double> point_area) {
  const View<const Active> terms = set.terms.view();
  device::parallel_for("contact.face_points", terms.n, [=] MORTISE_HD(Index i) {
    const Index point = terms[i].point[0];
    const auto mine = [&](Index j) { return j >= 0 && j < terms.n && terms[j].kind <= TermKind::triangle && terms[j].point[0] == point; };
    if (!mine(i) || mine(i - 1)) return;  // the first of the point's terms speaks for all
    Vec3 force = Vec3::Zero();
    for (Index j = i; mine(j); ++j) {
      Vec3 grad[4];
      NoHessian none;
      differentiate(s, terms[j], y, false, grad, none);
      force -= grad[0];
    }
    const double size = force.norm();
    if (size > 0) point_area[point] = facing_area(s, point, force / size, y);
  });
}

void count_blocks(const ActiveSet& set, const model::PointMapView& point_map, Buffer<Index>& counts) {
  const model::PointMapView map = point_map;
  const View<const Active> terms = set.terms.view();
  counts.resize(terms.n + 1);
  const View<Index> count = counts.view();
  device::parallel_for("contact.count_blocks", terms.n,
                       [=] MORTISE_HD(Index i) { count[i] = model::expand<4>(map, terms[i].point, points_of(terms[i].kind)).blocks; });
}

void assemble(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, const model::PointMapView& map, Curvature curvature,
              linalg::StencilSet& stencils) {
  const View<const Active> terms = set.terms.view();
  if (curvature.wanted) stencils.need_hessian();
  const linalg::StencilView out = stencils.view();
  device::parallel_for("contact.assemble", terms.n, [=] MORTISE_HD(Index i) {
    const model::Expansion<4> e = model::expand<4>(map, terms[i].point, points_of(terms[i].kind));
    const Index at = out.offset[i];
    for (Index b = 0; b < e.blocks; ++b) out.block[at + b] = e.block[b];
    if (curvature.wanted) model::zero_hessian(out, i, e.blocks);
    AddTerms add{e, out, i, curvature.concavity(terms[i].env)};
    Vec3 grad[4];
    differentiate(s, terms[i], y, curvature.wanted, grad, add);
    e.chain(grad, out.grad.p + at);
  });
}

void samples(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, Buffer<ContactSample>& out) {
  const View<const Active> terms = set.terms.view();
  out.resize(terms.n);
  const View<ContactSample> to = out.view();
  device::parallel_for("contact.samples", terms.n, [=] MORTISE_HD(Index i) { to[i] = sample_of(s, terms[i], y); });
}

void sample_changes(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, model::SampleChanges& out) {
  const View<const Active> terms = set.terms.view();
  out.resize(terms.n, kFunctionals);
  out.sizes = set.sizes;
  const model::SampleChangesView to = out.view();
  device::parallel_for("contact.sample_changes", terms.n, [=] MORTISE_HD(Index i) { change(s, terms[i], y, to, i); });
}

void point_forces(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, Buffer<Vec3>& out) {
  const View<const Active> terms = set.terms.view();
  out.resize(4 * terms.n);
  const View<Vec3> to = out.view();
  device::parallel_for("contact.forces", terms.n, [=] MORTISE_HD(Index i) {
    Vec3 grad[4] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    NoHessian none;
    differentiate(s, terms[i], y, false, grad, none);
    for (Index k = 0; k < 4; ++k) to[4 * i + k] = -grad[k];
  });
}

}  // namespace mortise::effects::contact
