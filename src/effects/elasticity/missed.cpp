#include "effects/elasticity/missed.h"

#include "effects/elasticity/recovery.h"
#include "model/held_points.h"

namespace mortise::effects::elasticity {
namespace {

// A field that is linear in a quadratic tetrahedron, at node a, has this share of its value at point p: the points lie on the way from the middle to
// the corners.
MORTISE_HD inline double extended(int a, int p) {
  double l[4];
  geometry::tet_point(0, l);
  const double other = -l[1] / (l[0] - l[1]), own = (1 - l[1]) / (l[0] - l[1]);
  if (a < 4) return a == p ? own : other;
  return (geometry::edge_begin(a - 4) == p || geometry::edge_end(a - 4) == p) ? 0.5 * (own + other) : other;
}

// int N_a N_b dV / V of a linear (n = 4) or quadratic tetrahedron.
MORTISE_HD inline double overlap(int n, int one, int other) {
  if (n == 4) return one == other ? 0.1 : 0.05;
  const int a = one < other ? one : other, b = one < other ? other : one;
  if (b < 4) return (a == b ? 6 : 1) / 420.0;
  const int i = geometry::edge_begin(b - 4), j = geometry::edge_end(b - 4);
  if (a < 4) return (a == i || a == j ? -4 : -6) / 420.0;
  if (a == b) return 32 / 420.0;
  const int k = geometry::edge_begin(a - 4), l = geometry::edge_end(a - 4);
  return (i == k || i == l || j == k || j == l ? 16 : 8) / 420.0;
}

struct Elements {
  Tets tets;
  View<const Index> first_node;
  View<const double> one_sided, cluster_lambda;

  MORTISE_HD int nodes(Index t) const { return first_node[t + 1] - first_node[t]; }
  MORTISE_HD int points(Index t) const { return tets.first_point[t + 1] - tets.first_point[t]; }
  MORTISE_HD double extends(Index t, int a, int p) const { return points(t) == 1 ? 1 : extended(a, p); }
  MORTISE_HD double volume(Index t) const {
    double sum = 0;
    for (Index p = tets.first_point[t]; p < tets.first_point[t + 1]; ++p) sum += tets.volume[p];
    return sum;
  }
  MORTISE_HD State at_node(Index t, int a, View<const State> of_points) const {
    State sum = State::Zero();
    for (int p = 0; p < points(t); ++p) sum += extends(t, a, p) * of_points[tets.first_point[t] + p];
    return sum;
  }
  // That which acts on a mean, of the element or of its cluster; else 0.
  MORTISE_HD double mean_lambda(Index t) const { return in_cluster(t) ? cluster_lambda[tets.cluster[t]] : tets.mean_lambda[t]; }
  MORTISE_HD bool in_cluster(Index t) const { return tets.cluster.n > 0 && tets.cluster[t] >= 0; }
};

MORTISE_HD inline State state_of(const Element& e, const Mat3& F, bool averages) {
  const Mat3 s = cauchy_stress(e.model, F, e.mu, e.lambda, e.pressure);
  const double trace = s(0, 0) + s(1, 1) + s(2, 2);
  State out;
  out[6] = averages ? dilation(e.model, F) : trace / (2 * e.mu + 3 * e.lambda);
  out[7] = averages ? (trace - (2 * e.mu + 3 * e.lambda) * out[6]) / 3 : 0;
  const double pressure = e.lambda * out[6] + out[7];
  for (int k = 0; k < 3; ++k) out[k] = (s(k, k) - pressure) / (2 * e.mu), out[3 + k] = s(k, (k + 1) % 3) / (2 * e.mu);
  return out;
}

// B(u, .) by strain, without what goes through p.
MORTISE_HD inline Mat3 stress_by(const State& u, double mu, double pressure) {
  Mat3 out;
  for (int k = 0; k < 3; ++k) out(k, k) = 2 * mu * u[k] + pressure, out(k, (k + 1) % 3) = out((k + 1) % 3, k) = 2 * mu * u[3 + k];
  return out;
}

// lambda at points, and that of the mean, 0 without.
MORTISE_HD inline double product(const State& u, const State& z, double mu, double lambda, double of_mean) {
  const double shear = u.head<3>().dot(z.head<3>()) + 2 * u.segment<3>(3).dot(z.segment<3>(3));
  return 2 * mu * shear + lambda * u[6] * z[6] + (of_mean > 0 ? u[7] * z[6] + u[6] * z[7] - u[7] * z[7] / of_mean : 0);
}

}  // namespace

Missed::Missed(const model::Model& model) : model_(model) {
  const Recovery recovery(model), back = recovery.transposed(model.volume.rest_volume.size());
  star_.first.upload(recovery.first), star_.of.upload(recovery.point), star_.weight.upload(recovery.weight);
  back_.first.upload(back.first), back_.of.upload(back.point), back_.weight.upload(back.weight);
  const Index elements = model.volume.tets.size();
  const std::vector<Tet> tet = model.volume.tets.download();
  const std::vector<geometry::Midsides> midsides = model.volume.midsides.download();
  const std::vector<Index> first_point = model.volume.first_point.download();
  std::vector<Index> first_node{0}, block;
  for (Index t = 0; t < elements; ++t) {
    block.insert(block.end(), std::begin(tet[t].v), std::end(tet[t].v));
    if (first_point[t + 1] - first_point[t] > 1) block.insert(block.end(), std::begin(midsides[t].v), std::end(midsides[t].v));
    first_node.push_back(static_cast<Index>(block.size()));
  }
  std::vector<Index> first_place(model.blocks + 1, 0), place(block.size());
  for (Index b : block) ++first_place[b + 1];
  for (Index b = 0; b < model.blocks; ++b) first_place[b + 1] += first_place[b];
  std::vector<Index> next = first_place;
  for (Index k = 0; k < static_cast<Index>(block.size()); ++k) place[next[block[k]]++] = k;

  const std::vector<bool> held = model::held_points(model.input);
  const std::vector<Index> cluster = model.clusters.of_tet.download();
  std::vector<double> one_sided(elements, 1.0);
  for (const model::Body& body : model.bodies) {
    const double of_body = model::one_sided(held, body.point_begin, body.point_end - body.point_begin);
    for (Index t = body.tet_begin; t < body.tet_end; ++t)
      if (first_point[t + 1] - first_point[t] == 1 && (cluster.empty() || cluster[t] < 0)) one_sided[t] = of_body;
  }
  first_node_.upload(first_node), first_place_.upload(first_place), place_.upload(place), one_sided_.upload(one_sided);
}

void Missed::mend(const Tets& tets, Positions q, double share, bool sheared) {
  const Elements in{tets, first_node_.view(), one_sided_.view(), model_.clusters.lambda.view()};
  device::Buffer<State> points(tets.volume.n), of_nodes(model_.blocks), of_places(place_.size());
  const View<State> s = points.view(), node = of_nodes.view(), at = of_places.view();
  const SumsView star = star_.view(), back = back_.view();
  const View<const Index> first_place = first_place_.view(), place = place_.view();

  device::parallel_for("elasticity.states", tets.size(), [=] MORTISE_HD(Index t) {
    at_points(in.tets, t, q, [&](int p, const Element& e, const Mat3& F) { s[in.tets.first_point[t] + p] = state_of(e, F, in.mean_lambda(t) > 0); });
  });
  device::parallel_for("elasticity.star", node.n, [=] MORTISE_HD(Index b) { node[b] = star.sum(b, {s.p, s.n}); });
  // The integral of D s with every shape function, and of half its product with itself.
  device::Buffer<double> energies(tets.size());
  const View<double> energy = energies.view();
  device::parallel_for("elasticity.jumps", tets.size(), [=] MORTISE_HD(Index t) {
    const int n = in.nodes(t);
    State jump[10];
    for (int a = 0; a < n; ++a) jump[a] = node[in.tets.node(t, a)] - in.at_node(t, a, {s.p, s.n});
    for (int a = 0; a < n; ++a) {
      State sum = State::Zero();
      for (int b = 0; b < n; ++b) sum += overlap(n, a, b) * jump[b];
      at[in.first_node[t] + a] = (in.one_sided[t] * in.volume(t)) * sum;
    }
    energy[t] = 0;
    for (int a = 0; a < n; ++a)
      energy[t] += 0.5 * product(at[in.first_node[t] + a], jump[a], sheared ? in.tets.mu[t] : 0, in.tets.lambda[t], in.mean_lambda(t));
  });
  energy_ = -share * device::sum("elasticity.missed_energy", energy.n, [=] MORTISE_HD(Index t) { return energy[t]; });
  // What that is to states: the way back through s*, and through what is taken off.
  device::parallel_for("elasticity.star_back", node.n, [=] MORTISE_HD(Index b) {
    State sum = State::Zero();
    for (Index i = first_place[b]; i < first_place[b + 1]; ++i) sum += at[place[i]];
    node[b] = sum;
  });
  device::parallel_for("elasticity.jumps_back", tets.size(), [=] MORTISE_HD(Index t) {
    for (int p = 0; p < in.points(t); ++p) {
      const Index of = in.tets.first_point[t] + p;
      State sum = back.sum(of, {node.p, node.n});
      for (int a = 0; a < in.nodes(t); ++a) sum -= in.extends(t, a, p) * at[in.first_node[t] + a];
      s[of] = sum;
    }
  });
  // (theta - p / lambda) of the members of clusters, over their volume: of linear elements.
  device::Buffer<double> means(model_.clusters.size());
  const View<double> mean = means.view();
  const View<const Index> first_tet = model_.clusters.first_tet.view(), member = model_.clusters.tet.view();
  const View<const double> cluster_volume = model_.clusters.volume.view();
  device::parallel_for("elasticity.missed_volume", mean.n, [=] MORTISE_HD(Index c) {
    double sum = 0;
    for (Index i = first_tet[c]; i < first_tet[c + 1]; ++i) {
      const State& of = s[in.tets.first_point[member[i]]];
      sum += of[6] - of[7] / in.cluster_lambda[c];
    }
    mean[c] = sum / cluster_volume[c];
  });
  // Of a strain that nodes make: B by e, by theta, and by p, which is the mean of lambda times theta.
  forces_.resize(place_.size());
  const View<Vec3> force = forces_.view();
  device::parallel_for("elasticity.missed_forces", tets.size(), [=] MORTISE_HD(Index t) {
    const int n = in.nodes(t);
    const Index first = in.tets.first_point[t];
    const double lambda = in.mean_lambda(t);
    double over = 0;  // of the element or its cluster, per volume
    if (in.in_cluster(t)) {
      over = mean[in.tets.cluster[t]];
    } else if (lambda > 0) {
      for (int p = 0; p < in.points(t); ++p) over += s[first + p][6] - s[first + p][7] / lambda;
      over /= in.volume(t);
    }
    Vec3* out = force.p + in.first_node[t];
    for (int a = 0; a < n; ++a) out[a] = Vec3::Zero();
    at_points(in.tets, t, q, [&](int p, const Element& e, const Mat3& F) {
      const State& of = s[first + p];
      const double pressure = e.lambda * of[6] + (lambda > 0 ? of[7] + e.volume * lambda * over : 0);
      const Mat3 T = -share * stress_by(of, sheared ? e.mu : 0, pressure) * dilation_slope(e.model, F);
      Vec3 g[10];
      if (n > 4)
        quadratic_gradients(e.dm_inverse, p, g);
      else
        for (int a = 0; a < 4; ++a) g[a] = shape_gradient(e.dm_inverse, a);
      for (int a = 0; a < n; ++a) out[a] += T * g[a];
    });
  });
}

void Missed::add_to(const linalg::StencilView& out) const {
  const View<const Vec3> force = forces_.view();
  const View<const Index> first = first_node_.view();
  device::parallel_for("elasticity.mend", first.n - 1, [=] MORTISE_HD(Index t) {
    for (Index a = 0; a < first[t + 1] - first[t]; ++a) out.grad[out.offset[t] + a] += force[first[t] + a];
  });
}

}  // namespace mortise::effects::elasticity
