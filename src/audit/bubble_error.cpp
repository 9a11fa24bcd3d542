#include "audit/bubble_error.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "audit/entries.h"
#include "audit/tuning.h"
#include "audit/vector_at.h"
#include "geometry/nearest_triangle.h"
#include "geometry/quadratic.h"
#include "model/bonded.h"
#include "model/held_points.h"
#include "model/select.h"

namespace mortise::audit {

namespace {

constexpr unsigned kAllAxes = 7;

// Barycentric coordinates of the points of integration of a bubble's stiffness.
struct Points {
  double l[geometry::kTetPoints][4];
  Points() {
    for (int q = 0; q < geometry::kTetPoints; ++q) geometry::tet_point(q, l[q]);
  }
};

double dot(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

bool BubbleError::counts_for(const model::BodyInput& body) {
  std::vector<bool> outside(body.nodes.size(), false);
  for (const Triangle& t : body.triangles)
    for (const Index v : t.v) outside[static_cast<std::size_t>(v)] = true;
  return body.midsides.empty() && 2 * std::count(outside.begin(), outside.end(), false) <= static_cast<std::ptrdiff_t>(outside.size());
}

BubbleError::BubbleError(const model::ModelInput& input, const model::BodyInput& body)
    : name_(body.name),
      rest_(body.nodes),
      triangles_(body.triangles),
      E_(body.material.number("youngs_modulus")),
      nu_(body.material.number("poisson_ratio")) {
  const double nu = std::min(nu_, tuning::kCompressible);
  lambda_ = E_ * nu / ((1 + nu) * (1 - 2 * nu)), mu_ = E_ / (2 * (1 + nu));
  std::map<std::array<Index, 2>, Index> number;
  const auto edge = [&](Index a, Index b) {
    const std::array<Index, 2> ends{std::min(a, b), std::max(a, b)};
    const auto [at, is_new] = number.emplace(ends, static_cast<Index>(edges_.size()));
    if (is_new) edges_.push_back(ends);
    return at->second;
  };
  for (const Tet& t : body.tets) {
    Element e;
    std::copy_n(t.v, 4, e.node);
    Mat3 sides;
    for (int k = 0; k < 3; ++k) sides.col(k) = rest_[t.v[k + 1]] - rest_[t.v[0]];
    const Mat3 inverse = sides.inverse();
    e.volume = sides.determinant() / 6;
    for (int k = 0; k < 3; ++k) e.g[k + 1] = inverse.row(k);
    e.g[0] = -(e.g[1] + e.g[2] + e.g[3]);
    for (int k = 0; k < 6; ++k) e.edge[k] = edge(t.v[geometry::edge_begin(k)], t.v[geometry::edge_end(k)]);
    elements_.push_back(e);
  }
  for (const Triangle& t : triangles_) sides_.push_back({edge(t.v[0], t.v[1]), edge(t.v[1], t.v[2]), edge(t.v[2], t.v[0])});
  held_.assign(edges_.size(), 0), acted_.assign(rest_.size(), false);
  const Params* found = input.scene.find("effects");
  const Params effects = found ? *found : Params::make_table();
  for (const Params& p : entries(effects, "pin"))
    if (p.text("body") == name_ && !p.has("release") && p.has("where")) hold(model::select(rest_, p.find("where")), model::mask_of(p.text("axes")));
  for (const Params& p : entries(effects, "pressure_load"))
    if (p.text("body") == name_) hold(model::select(rest_, p.find("where")), kAllAxes);
  for (const model::BodyInput& other : input.bodies) {
    for (const Params& p : entries(effects, "bond"))
      if (p.text("body") == name_ && p.text("to") == other.name) hold(model::bonded(p, body, other), kAllAxes);
    for (const Params& p : entries(effects, "mortar_tie")) {
      if (p.text("body") == name_) hold(model::select(rest_, p.find("where")), kAllAxes);
      if (p.text("to") == name_ && p.text("body") == other.name) hold_under_tie(other, p);
    }
  }
}

void BubbleError::hold(const std::vector<Index>& nodes, Axes axes) {
  std::vector<bool> in(rest_.size(), false);
  for (const Index i : nodes) in[static_cast<std::size_t>(i)] = acted_[static_cast<std::size_t>(i)] = true;
  for (std::size_t e = 0; e < edges_.size(); ++e)
    if (in[edges_[e][0]] && in[edges_[e][1]]) held_[e] |= axes;
}

// The other side of a tie: faces that lie on those which are tied to them.
void BubbleError::hold_under_tie(const model::BodyInput& slave, const Params& tie) {
  std::vector<bool> in(slave.nodes.size(), false);
  for (const Index i : model::select(slave.nodes, tie.find("where"))) in[static_cast<std::size_t>(i)] = true;
  std::vector<Triangle> tied;
  for (const Triangle& t : slave.triangles)
    if (std::all_of(std::begin(t.v), std::end(t.v), [&](Index v) { return in[v]; })) tied.push_back(t);
  const geometry::NearestTriangle near(slave.nodes, tied);
  std::vector<double> distance;
  for (const Vec3& x : rest_) distance.push_back(near.distance(x));
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Index* v = triangles_[t].v;
    const double size = (rest_[v[1]] - rest_[v[0]]).norm();
    for (int k = 0; k < 3; ++k)
      if (distance[v[k]] < size) acted_[v[k]] = true;
    if (std::all_of(v, v + 3, [&](Index i) { return distance[i] < tuning::kOnTie * size; }))
      for (const Index e : sides_[t]) held_[e] = kAllAxes;
  }
}

std::vector<BubbleError::Axes> BubbleError::held(std::span<const double> contact_force, std::span<const double> displacement, double& share) const {
  std::vector<Axes> out = held_;
  const auto x = [&](Index i) { return Vec3(rest_[i] + at(displacement, i)); };
  for (std::size_t t = 0; t < triangles_.size() && !contact_force.empty(); ++t) {
    const Index* v = triangles_[t].v;
    const Vec3 normal = (x(v[1]) - x(v[0])).cross(x(v[2]) - x(v[0])).normalized();
    const auto presses = [&](Index i) {
      const Vec3 f = at(contact_force, i);
      return -f.dot(normal) > tuning::kFacesContact * f.norm();
    };
    if (std::all_of(v, v + 3, presses))
      for (const Index e : sides_[t]) out[e] = kAllAxes;
  }
  double all = 0, of_held = 0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Index* v = triangles_[t].v;
    const double area = (rest_[v[1]] - rest_[v[0]]).cross(rest_[v[2]] - rest_[v[0]]).norm();
    all += area;
    if (std::all_of(sides_[t].begin(), sides_[t].end(), [&](Index e) { return out[e] == kAllAxes; })) of_held += area;
  }
  share = all > 0 ? of_held / all : 0;
  return out;
}

// Gradient of the bubble on edge k where the barycentric coordinates are l.
Vec3 BubbleError::slope_of(const Element& e, int k, const double (&l)[4]) {
  const int i = geometry::edge_begin(k), j = geometry::edge_end(k);
  return 4 * (l[i] * e.g[j] + l[j] * e.g[i]);
}

std::vector<Vec3> BubbleError::times(const std::vector<Vec3>& x) const {
  static const Points points;
  std::vector<Vec3> y(x.size(), Vec3::Zero());
  for (const Element& e : elements_)
    for (const double(&l)[4] : points.l) {
      Vec3 slope[6];
      Mat3 H = Mat3::Zero();
      for (int k = 0; k < 6; ++k) {
        slope[k] = slope_of(e, k, l);
        H += x[e.edge[k]] * slope[k].transpose();
      }
      const Mat3 S = e.volume / geometry::kTetPoints * (lambda_ * H.trace() * Mat3::Identity() + mu_ * (H + H.transpose()));
      for (int k = 0; k < 6; ++k) y[e.edge[k]] += S * slope[k];
    }
  return y;
}

std::vector<Vec3> BubbleError::body_force(const std::vector<Mat3>& S, std::span<const double> contact_force) const {
  std::vector<Vec3> force(rest_.size(), Vec3::Zero());
  std::vector<double> volume(rest_.size(), 0.0);
  for (std::size_t t = 0; t < elements_.size(); ++t)
    for (int k = 0; k < 4; ++k) {
      const Element& e = elements_[t];
      force[e.node[k]] += e.volume * (S[t] * e.g[k]), volume[e.node[k]] += e.volume / 4;
    }
  for (std::size_t i = 0; i < force.size(); ++i)
    if (acted_[i] || (!contact_force.empty() && at(contact_force, i) != Vec3::Zero())) force[i].setZero();
  for (std::size_t i = 0; i < force.size(); ++i)
    if (volume[i] > 0) force[i] /= volume[i];
  return force;
}

double BubbleError::of(const std::vector<Stress>& stress, std::span<const double> contact_force, std::span<const double> displacement) const {
  static const Points points;
  double share = 0, energy = 0;
  const std::vector<Axes> held = this->held(contact_force, displacement, share);
  std::vector<Vec3> r(edges_.size(), Vec3::Zero());
  std::vector<Mat3> block(edges_.size(), Mat3::Zero());
  std::vector<Mat3> S;
  for (const Stress& s : stress) {
    S.emplace_back();
    S.back() << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  }
  const std::vector<Vec3> force = body_force(S, contact_force);
  for (std::size_t t = 0; t < elements_.size(); ++t) {
    const Element& e = elements_[t];
    const double trace = S[t].trace();
    energy += e.volume * ((1 + nu_) * S[t].squaredNorm() - nu_ * trace * trace) / (2 * E_);
    Vec3 b = Vec3::Zero();
    int known = 0;
    for (const Index i : e.node)
      if (force[i] != Vec3::Zero()) b += force[i], ++known;
    if (known > 0) b /= known;
    for (int k = 0; k < 6; ++k) r[e.edge[k]] += e.volume * (b / 5 - S[t] * (e.g[geometry::edge_begin(k)] + e.g[geometry::edge_end(k)]));
    for (const double(&l)[4] : points.l)
      for (int k = 0; k < 6; ++k) {
        const Vec3 slope = slope_of(e, k, l);
        block[e.edge[k]] +=
            e.volume / geometry::kTetPoints * ((lambda_ + mu_) * slope * slope.transpose() + mu_ * slope.squaredNorm() * Mat3::Identity());
      }
  }
  // Conjugate gradients, with the blocks of the edges as preconditioner; what is held stays where it is.
  const auto keep = [&](std::vector<Vec3>& v) {
    for (std::size_t i = 0; i < v.size(); ++i)
      for (int a = 0; a < 3; ++a)
        if (held[i] >> a & 1u) v[i][a] = 0;
  };
  for (std::size_t i = 0; i < block.size(); ++i) {
    for (int a = 0; a < 3; ++a)
      if (held[i] >> a & 1u) block[i].row(a).setZero(), block[i].col(a).setZero(), block[i](a, a) = 1;
    block[i] = block[i].inverse().eval();
  }
  const auto preconditioned = [&](const std::vector<Vec3>& v) {
    std::vector<Vec3> z(v.size());
    for (std::size_t i = 0; i < v.size(); ++i) z[i] = block[i] * v[i];
    return z;
  };
  keep(r);
  std::vector<Vec3> z = preconditioned(r), p = z;
  double rz = dot(r, z), missed = 0;
  const double first = rz;
  for (int k = 0; k < tuning::kBubbleIterations && rz > tuning::kBubbleTolerance * first; ++k) {
    std::vector<Vec3> Kp = times(p);
    keep(Kp);
    const double alpha = rz / dot(p, Kp);
    missed += 0.5 * alpha * rz;
    for (std::size_t i = 0; i < r.size(); ++i) r[i] -= alpha * Kp[i];
    z = preconditioned(r);
    const double next = dot(r, z);
    for (std::size_t i = 0; i < p.size(); ++i) p[i] = z[i] + next / rz * p[i];
    rz = next;
  }
  return energy > 0 ? std::min((1 + tuning::kHeldMisses * share) * missed / energy, tuning::kMostMissed) : 0;
}

}  // namespace mortise::audit
