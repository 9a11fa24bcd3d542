#pragma once
// The contact samples of one position, frozen: weights, barycentrics, normals and support radii stay, and each gap is linear,
//     g(y) = g_0 + sum_b J_b . (y_b - y0_b),     E(y) = sum kappa w b(g(y); d_hat_i)   [J].
// This is the energy of the line search. Its gradient at y0 is the force of the method, its Hessian sum kappa w b'' J J^T is positive
// semi-definite. A frozen gap knows nothing of surfaces that slide away from under a sample, and may close although they do not meet: that of
// an edge beside a tip, of the side of a wedge. What keeps surfaces apart is continuous collision detection of the primitives, which leaves a
// tenth of every distance; below a tenth of its gap a sample therefore goes on along the tangent of its barrier, and cuts no step short.
// Half-spaces are without end, and quadratic faces are not among those primitives: their frozen gaps limit steps, and E is +infinity where one
// is not positive. The gap's derivative J is, per option `gradient`,
//     frozen  J = (M_b n, -N_a n)                                    (published)
//     exact   dg = [n_m . (dx_m - dx_s) - g n_m . dn] / (n_m . n),   dn = (I - n n^T) d(e1 x e2) / |e1 x e2|   (README),
// for faces; with m = n_m / (n_m . n), u = (I - n n^T) m / |e1 x e2| this is J = (M_b m, -N_a m - g k_a), k_1 = e2 x u,
// k_2 = u x e1, k_0 = -k_1 - k_2. Both give balanced forces and moments. Nothing is differentiated through the clipping: that
// would add the tension of a film with energy kappa b per area (README).
//
// N, M are the shape functions of the faces: linear ones, or those of the six nodes of a quadratic face, whose quarters are what is
// clipped. Normals, weights and k_a are those of the quarters; g counts between the quadratic faces, along the normal.
#include "effects/contact/barrier.h"
#include "effects/contact/proximity.h"
#include "effects/curvature.h"
#include "effects/mortar_contact/sampling.h"
#include "effects/mortar_contact/sheet.h"
#include "geometry/collide/bvh.h"
#include "linalg/stencils.h"
#include "model/contact_view.h"
#include "model/expand.h"
#include "model/model.h"

namespace mortise::effects::mortar {

// A slave triangle and a master triangle or half-space with samples between them: one stencil.
struct Pair {
  Index slave, master;  // triangles; master = -1 - h: half-space h
  Index env, interface;
  FaceNodes on, under;  // nodes of the slave, and of the master (none of a half-space)
  Vec3 n, m, k[3];
  double d_hat;
  Index begin, end;  // samples
  bool layered;      // other masters may hide a part of them
  bool turning;      // its faces have the three-term gradient: m, k are not n, 0
  MORTISE_HD bool quadratic() const { return on.quarter >= 0 || under.quarter >= 0; }
  MORTISE_HD bool binding() const { return master < 0 || quadratic(); }  // a gap that closes when frozen has closed
};

struct Sample {
  SampleKind kind;
  Index pair;
  double weight, gap;  // [m^2], [m]
  double N[3], M[3];
};

// The slave nodes that `gap: averaged` acts on (averaged.h): those with parts, the contributions of pairs to their nodes.
struct Averages {
  Buffer<Index> start, part;      // node i has parts part[start[i]] ... part[start[i+1] - 1]; environments contiguous
  Buffer<Index> node, interface;  // per part: its node; per node
  Buffer<double> area, gap;       // per node [m^2], [m]
  std::vector<Index> env_nodes;
};

// What becomes of a sample while nodes move: N_1, N_2, M_1, M_2 and w change by sum_k by . dy_k.
inline constexpr int kMoved = 5;
struct MovingView {
  View<const Index> start, node;  // of sample i: node[start[i]] ... node[start[i + 1] - 1], those of its pair first
  View<Vec3> by_;                 // [1/m], [m]
  MORTISE_HD Index count(Index i) const { return start[i + 1] - start[i]; }
  MORTISE_HD Vec3* by(Index i, int q) const { return by_.p + kMoved * start[i] + q * count(i); }
};
struct Motion {
  Buffer<Index> start, node;
  Buffer<Vec3> by;
  Buffer<std::uint8_t> partly;  // per sample: not 0 where something that moves it is left out
  linalg::StencilSizes sizes;   // of stencils of the samples' nodes
  Moving wanted = false;
  void clear() { wanted = false, start.resize(0), node.resize(0), by.resize(0), partly.resize(0); }
  bool any() const { return start.size() > 0; }
  std::size_t bytes() const { return start.bytes() + node.bytes() + by.bytes() + partly.bytes(); }
};

struct FrozenSamples {
  Buffer<Pair> pairs;  // environments contiguous, then by slave and master
  Buffer<Sample> samples;
  Buffer<double> pressure;                    // per sample [Pa]
  Averages averages;                          // empty unless the gap is averaged
  Motion moving;                              // empty unless it was wanted
  std::vector<Index> env_pairs, env_samples;  // offsets
  linalg::StencilSizes of_pairs, of_samples;  // of stencils of every pair's points, and of every sample's
  Buffer<Vec3> y;                             // where they were taken
};

// The barrier at gap g of what was frozen at gap g0.
MORTISE_HD inline double frozen_barrier(double g, double g0, double d_hat) {
  const double least = tuning::kTangent * std::fmin(g0, d_hat);
  return g > least ? barrier::value(g, d_hat) : barrier::value(least, d_hat) + barrier::first(least, d_hat) * (g - least);
}

// Nodes of the slave, then of the master.
inline constexpr int kPoints = 12;
MORTISE_HD inline int points_of(const Pair& p) { return p.on.count + p.under.count; }
MORTISE_HD inline Index point_of(const Pair& p, int i) { return i < p.on.count ? p.on.point[i] : p.under.point[i - p.on.count]; }

// dg/dy of the pair's points.
MORTISE_HD inline void jacobian(const Pair& p, const Sample& s, Vec3 J[kPoints]) {
  const bool face = s.kind == SampleKind::face;
  const Vec3 d = face ? p.m : p.n;
  double w[6];
  p.on.shape(s.N, w);
  for (int a = 0; a < p.on.count; ++a) J[a] = -w[a] * d;
  if (face)
    for (int a = 0; a < 3; ++a) J[p.on.vertex(a)] -= s.gap * p.k[a];
  if (p.under.count == 0) return;
  p.under.shape(s.M, w);
  for (int b = 0; b < p.under.count; ++b) J[p.on.count + b] = w[b] * d;
}

// Whether two quadratic faces meet, although their quarters do not.
inline bool met(const Pair& p, double gap) { return p.quadratic() && gap <= tuning::kLeastGap * p.d_hat; }

MORTISE_HD inline model::Expansion<kPoints> blocks_of(const model::PointMapView& map, const FaceNodes& on, const FaceNodes& under) {
  Index point[kPoints];
  for (int k = 0; k < on.count; ++k) point[k] = on.point[k];
  for (int k = 0; k < under.count; ++k) point[on.count + k] = under.point[k];
  return model::expand<kPoints>(map, point, on.count + under.count);
}
MORTISE_HD inline model::Expansion<kPoints> blocks_of(const model::PointMapView& map, const Pair& p) { return blocks_of(map, p.on, p.under); }

// Finds the master triangles near every slave triangle.
class Search {
 public:
  Search() = default;
  // masters: triangles that may be seen, ascending, out of all `triangles`; slave_env, master_env: the first of every environment.
  Search(std::vector<Index> slave_env, const std::vector<Index>& masters, std::vector<Index> master_env, const std::vector<Triangle>& triangles);
  // From now on nothing is found for the slaves of other environments; empty: for those of all.
  void work_on(const std::vector<std::uint8_t>& whose) { whose_ = whose; }
  // Masters within support + margin[env] of each slave at y; ascending. Where `points` are named (per point) only pairs that have one
  // of these, within support + the longest edge of the slave.
  void update(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, View<const std::uint8_t> points = {});
  // The same in two halves, between which `fetch` brings how many there are: until then they have `room`, and nobody's places are among them. False:
  // it was too small.
  void begin(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, Index room, device::Fetch& fetch);
  bool end();
  Index found() const { return found_; }
  // How many every slave has, and which: what both do (nvcc takes no kernels from private functions).
  void count(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, View<const std::uint8_t> points);
  void list(const MortarView& s, View<const Vec3> y, const Buffer<double>& margin, Index room, View<const std::uint8_t> points);
  View<const Index> offset() const { return offset_.view(); }
  View<const Index> slave() const { return slave_.view(); }    // per candidate: which slave
  View<const Index> master() const { return master_.view(); }  // per candidate: triangle, or -1 - half-space, or kNobody
  static constexpr Index kNobody = std::numeric_limits<Index>::min();
  const std::vector<Index>& slave_env() const { return slave_env_; }
  device::Ranges slaves() const { return {slave_env_, whose_}; }  // that are worked on
  std::size_t bytes() const { return offset_.bytes() + slave_.bytes() + master_.bytes(); }

 private:
  geometry::Bvh tree_;
  std::vector<Index> slave_env_, master_env_;
  std::vector<std::uint8_t> whose_;
  Buffer<Index> masters_;     // primitives of the tree: only those that may be seen, or slaves would find their own neighbours first
  Buffer<Triangle> corners_;  // of the masters
  Buffer<double> bow_;        // of the masters, as in MortarView
  Buffer<Index> offset_, slave_, master_;
  Index found_ = 0;
};

// Normals and areas of the triangles of `whose`; bow [m]: the most by which a quadratic face stands off its quarter, empty where all are linear.
void measure(const geometry::SurfaceView& surface, const model::QuadraticFaces& faces, View<const Vec3> y, const device::Ranges& whose,
             Buffer<Vec3>& normal, Buffer<double>& area, Buffer<double>& bow);

// Smallest gap of every slave at y to the corners of what it sees, INFINITY where that is not below support. The search is that of y.
void least_gaps(const MortarView& s, const Search& search, View<const Vec3> y, Buffer<double>& out);
// What of a candidate's slave lies under its master, as a share of the slave's area, and there int N dA, int M dA [m^2]. Half-spaces cover all.
struct Cover {
  Index slave, master;  // triangles; master = -1 - h: half-space h
  double share, N[3], M[3];
};
// Of every candidate of the search, however far apart they are; nothing where they do not face each other.
void cover(const MortarView& s, const Search& search, View<const Vec3> y, Buffer<Cover>& out);

// In the environments of `whose`; empty: in all.
void energy(const MortarView& s, const FrozenSamples& f, View<const Vec3> y, const std::vector<std::uint8_t>& whose, device::EnvValues per_env);

// Stencils 0..pairs of f, and after them those of `guard` unchanged.
void assemble(const MortarView& s, const FrozenSamples& f, const model::PointMapView& map, bool hessian, linalg::StencilSet& guard,
              linalg::StencilSet& out);

// Lowers alpha[e] so that every sample of pairs whose frozen gaps count, and every corner of their clipped overlaps, keeps the share `keep`
// of its gap (linearised).
void limit(const MortarView& s, const FrozenSamples& f, View<const Vec3> dy, double keep, device::EnvValues alpha);

void samples(const MortarView& s, const FrozenSamples& f, model::ContactView& view);

}  // namespace mortise::effects::mortar
