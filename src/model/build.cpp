#include "model/build.h"

#include <algorithm>
#include <array>

#include "geometry/quadratic.h"
#include "geometry/tet_rule.h"
#include "geometry/topology.h"
#include "model/clusters.h"
#include "model/model.h"
#include "model/points_of.h"
#include "model/select.h"
#include "model/stiff_mass.h"
#include "model/volumetric.h"

namespace mortise::model {
namespace {

// Host arrays that grow body by body and are uploaded once.
struct Layout {
  std::vector<Vec3> rest, velocity, points;
  std::vector<Index> block_env, point_offset{0}, point_block, point_body, point_env;
  std::vector<double> point_weight;
  std::vector<Tet> tets;
  std::vector<geometry::Midsides> midsides;
  std::vector<Index> first_point{0};
  std::vector<Mat3> dm_inverse;
  std::vector<double> rest_volume, mu, lambda, mean_lambda;
  ClusterLists clusters;
  std::vector<std::uint8_t> material;
  std::vector<Triangle> triangles;
  std::vector<geometry::Face> faces;
  std::vector<Index> quarter;
  // Mass entries (row, column, kg), both triangles.
  struct Entry {
    Index row, column;
    double value;
  };
  std::vector<Entry> mass;
};

MaterialModel material_model(const Params& material) {
  const std::string& name = material.text("model");
  if (name == "linear") return MaterialModel::linear;
  if (name == "corotated") return MaterialModel::corotated;
  return MaterialModel::neo_hookean;
}

// dX/d(l1, l2, l3) of a quadratic tetrahedron whose nodes are X.
Mat3 rest_jacobian(const std::array<Vec3, 10>& X, const double l[4]) {
  Mat3 J = Mat3::Zero();
  for (int a = 0; a < 10; ++a) J += X[a] * geometry::tet_slope(a, l).transpose();
  return J;
}

[[noreturn]] void inside_out(const BodyInput& in, const Body& body, std::size_t t, double volume) {
  throw Error(Exit::scene, body.where,
              "body '" + in.name + "': tetrahedron " + std::to_string(t) + " has volume " + std::to_string(volume) + " m^3; it must be positive");
}

// Linear: one point; the consistent mass, int rho N_a N_b dV = rho V (1 + delta_ab) / 20: a body that turns has its moments of inertia then, where
// masses lumped on the corners of n cells across a cube have 1 + 2/n^2 times as much.
void add_linear(Layout& l, const BodyInput& in, Body& body, std::size_t t, Vec3& moment) {
  const Tet& tet = in.tets[t];
  Mat3 dm;
  for (int k = 0; k < 3; ++k) dm.col(k) = in.nodes[tet.v[k + 1]] - in.nodes[tet.v[0]];
  const double volume = dm.determinant() / 6;
  if (!(volume > 0)) inside_out(in, body, t, volume);
  l.dm_inverse.push_back(dm.inverse());
  l.rest_volume.push_back(volume);
  body.volume += volume;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j)
      l.mass.push_back({body.block_begin + tet.v[k], body.block_begin + tet.v[j], body.density * volume / 20 * (j == k ? 2 : 1)});
    moment += volume / 4 * in.nodes[tet.v[k]];
  }
}

// Quadratic: four points; the consistent mass m_ab = int rho N_a N_b dV, because lumped by rows the corners would weigh less than
// nothing. Its row sums are the consistent load of gravity.
void add_quadratic(Layout& l, const BodyInput& in, Body& body, std::size_t t, Vec3& moment) {
  std::array<Index, 10> node;
  for (int k = 0; k < 10; ++k) node[k] = k < 4 ? in.tets[t].v[k] : in.midsides[t].v[k - 4];
  std::array<Vec3, 10> X;
  for (int k = 0; k < 10; ++k) X[k] = in.nodes[node[k]];
  double at[4];
  for (int p = 0; p < geometry::kTetPoints; ++p) {
    geometry::tet_point(p, at);
    const Mat3 J = rest_jacobian(X, at);
    const double volume = J.determinant() / 6 / geometry::kTetPoints;
    if (!(volume > 0)) inside_out(in, body, t, volume);
    l.dm_inverse.push_back(J.inverse());
    l.rest_volume.push_back(volume);
  }
  Eigen::Matrix<double, 10, 10> m = Eigen::Matrix<double, 10, 10>::Zero();
  for (const geometry::TetRulePoint& p : geometry::tet_rule_5()) {
    const double dV = p.weight * rest_jacobian(X, p.l).determinant() / 6;
    double N[10];
    for (int a = 0; a < 10; ++a) N[a] = geometry::tet_shape_function(a, p.l);
    for (int a = 0; a < 10; ++a)
      for (int b = 0; b < 10; ++b) m(a, b) += body.density * dV * (N[a] * N[b]);  // symmetric to the last bit
    body.volume += dV;
    for (int a = 0; a < 10; ++a) moment += dV * N[a] * X[a];
  }
  for (int a = 0; a < 10; ++a)
    for (int b = 0; b < 10; ++b) l.mass.push_back({body.block_begin + node[a], body.block_begin + node[b], m(a, b)});
}

void add_soft(Layout& l, const BodyInput& in, Body& body) {
  const Index first = body.block_begin;
  const double E = body.youngs_modulus, nu = body.poisson_ratio;
  const bool quadratic = !in.midsides.empty(), averaged = averages_volume(in);
  const Lambda lambda = lambda_of(E, nu, averaged, quadratic);
  std::vector<std::uint8_t> used(in.nodes.size(), 0);
  body.tet_begin = static_cast<Index>(l.tets.size());
  Vec3 moment = Vec3::Zero();
  for (std::size_t t = 0; t < in.tets.size(); ++t) {
    const Tet& tet = in.tets[t];
    geometry::Midsides middle{{-1, -1, -1, -1, -1, -1}};
    for (Index v : tet.v) used[v] = 1;
    if (quadratic) {
      add_quadratic(l, in, body, t, moment);
      for (int k = 0; k < 6; ++k) middle.v[k] = first + in.midsides[t].v[k], used[in.midsides[t].v[k]] = 1;
    } else {
      add_linear(l, in, body, t, moment);
    }
    l.tets.push_back({{first + tet.v[0], first + tet.v[1], first + tet.v[2], first + tet.v[3]}});
    l.midsides.push_back(middle);
    l.first_point.push_back(static_cast<Index>(l.rest_volume.size()));
    l.mu.push_back(E / (2 * (1 + nu)));
    l.lambda.push_back(lambda.at_points);
    l.mean_lambda.push_back(quadratic ? lambda.of_mean : 0);
    l.material.push_back(static_cast<std::uint8_t>(material_model(in.material)));
  }
  body.tet_end = static_cast<Index>(l.tets.size());
  if (averaged && !quadratic)
    l.clusters.add(star_clusters(in), l.tets, body.tet_begin, l.rest_volume.data() + l.first_point[body.tet_begin], lambda.of_mean, in.env);
  body.centre = moment / body.volume;
  body.mass = body.density * body.volume;
  const Vec3 v = in.params.vec3("velocity"), w = in.params.vec3("angular_velocity");
  for (std::size_t i = 0; i < in.nodes.size(); ++i) {
    const Index block = first + static_cast<Index>(i);
    if (!used[i]) throw Error(Exit::scene, body.where, "body '" + in.name + "': node " + std::to_string(i) + " belongs to no tetrahedron");
    l.rest.push_back(in.nodes[i]);
    l.velocity.push_back(v + w.cross(in.nodes[i] - body.centre));
    l.points.push_back(in.nodes[i]);
    l.point_block.push_back(block);
    l.point_weight.push_back(1);
    l.point_offset.push_back(static_cast<Index>(l.point_block.size()));
  }
}

void add_stiff(Layout& l, const BodyInput& in, Body& body) {
  const Index first = body.block_begin;
  const StiffMass m = stiff_mass(in);
  body.volume = m.volume;
  body.centre = m.centre;
  body.mass = m.mass;
  body.density = m.mass / m.volume;
  const Vec3 v = in.params.vec3("velocity"), w = in.params.vec3("angular_velocity");
  l.rest.push_back(m.centre);
  l.velocity.push_back(v);
  l.mass.push_back({first, first, body.mass});
  for (int k = 0; k < 3; ++k) {
    l.rest.push_back(Vec3::Unit(k));
    l.velocity.push_back(w.cross(Vec3::Unit(k)));
    // int rho X X^T dV about the centre of mass; the mixed terms with p vanish there.
    for (int j = 0; j < 3; ++j) l.mass.push_back({first + 1 + k, first + 1 + j, m.second_moment(k, j)});
  }
  for (const Vec3& node : in.nodes) {
    const Vec3 X = node - m.centre;
    l.points.push_back(node);
    for (int k = 0; k < 4; ++k) {
      l.point_block.push_back(first + k);
      l.point_weight.push_back(k == 0 ? 1 : X[k - 1]);
    }
    l.point_offset.push_back(static_cast<Index>(l.point_block.size()));
  }
}

void add_body(Layout& l, Model& model, const BodyInput& in) {
  Body body;
  body.name = in.name;
  body.type = in.type;
  body.env = in.env;
  body.where = in.params.where();
  if (in.type == BodyType::soft) {
    body.youngs_modulus = in.material.number("youngs_modulus");
    body.poisson_ratio = in.material.number("poisson_ratio");
    body.density = in.material.number("density");
  }
  body.block_begin = static_cast<Index>(l.rest.size());
  body.point_begin = static_cast<Index>(l.points.size());
  if (in.type == BodyType::soft)
    add_soft(l, in, body);
  else
    add_stiff(l, in, body);
  body.block_end = static_cast<Index>(l.rest.size());
  body.point_end = static_cast<Index>(l.points.size());
  body.triangle_begin = static_cast<Index>(l.triangles.size());
  for (const Triangle& t : in.triangles) l.triangles.push_back({{body.point_begin + t.v[0], body.point_begin + t.v[1], body.point_begin + t.v[2]}});
  body.triangle_end = static_cast<Index>(l.triangles.size());
  for (const geometry::Face& f : in.faces) {
    for (int q = 0; q < 4; ++q) l.quarter.push_back(4 * static_cast<Index>(l.faces.size()) + q);
    geometry::Face face;
    for (int k = 0; k < 6; ++k) face.v[k] = body.point_begin + f.v[k];
    l.faces.push_back(face);
  }
  l.quarter.resize(l.triangles.size(), -1);
  l.block_env.resize(l.rest.size(), in.env);
  l.point_env.resize(l.points.size(), in.env);
  l.point_body.resize(l.points.size(), static_cast<Index>(model.bodies.size()));
  model.bodies.push_back(std::move(body));
}

// offset[e] = first element of environment e in an array ordered by environment.
std::vector<Index> offsets_by_env(const std::vector<Index>& env_of, Index envs) {
  std::vector<Index> offset(envs + 1, 0);
  for (Index e : env_of) ++offset[e + 1];
  for (Index e = 0; e < envs; ++e) offset[e + 1] += offset[e];
  return offset;
}

void upload_clusters(ClusterLists& l, std::size_t tets, Index envs, Clusters& out) {
  out.env_offset = offsets_by_env(l.env, envs);
  out.env_nodes.clear();
  for (Index first : out.env_offset) out.env_nodes.push_back(l.first_node[first]);
  if (l.lambda.empty()) return;
  l.of_tet.resize(tets, -1);
  out.of_tet.upload(l.of_tet);
  out.first_tet.upload(l.first_tet), out.tet.upload(l.tet), out.slot.upload(l.slot);
  out.first_node.upload(l.first_node), out.node.upload(l.node), out.owner.upload(l.owner);
  out.lambda.upload(l.lambda), out.volume.upload(l.volume);
}

void upload_mass(Layout& l, Mass& mass, Index blocks) {
  std::stable_sort(l.mass.begin(), l.mass.end(),
                   [](const Layout::Entry& a, const Layout::Entry& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
  std::vector<Index> offset(blocks + 1, 0), column;
  std::vector<double> value;
  for (std::size_t i = 0; i < l.mass.size(); ++i) {
    const Layout::Entry& e = l.mass[i];
    if (i > 0 && e.row == l.mass[i - 1].row && e.column == l.mass[i - 1].column) {  // of a neighbouring tetrahedron
      value.back() += e.value;
      continue;
    }
    ++offset[e.row + 1];
    column.push_back(e.column);
    value.push_back(e.value);
  }
  for (Index b = 0; b < blocks; ++b) offset[b + 1] += offset[b];
  mass.row_offset.upload(offset);
  mass.column.upload(column);
  mass.value.upload(value);
}

void upload_surface(const Layout& l, geometry::Surface& surface, const std::vector<Body>& bodies) {
  const std::vector<Edge> edges = geometry::unique_edges(l.triangles);
  surface.vertex_area.upload(geometry::vertex_areas(l.points, l.triangles));
  surface.edge_area.upload(geometry::edge_areas(l.points, l.triangles, edges));
  std::vector<std::uint8_t> used(l.points.size(), 0);
  for (const Triangle& t : l.triangles)
    for (Index v : t.v) used[v] = 1;
  std::vector<Index> vertices;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) vertices.push_back(static_cast<Index>(i));
  surface.vertices.upload(vertices);
  surface.edges.upload(edges);
  surface.triangles.upload(l.triangles);
  surface.body.upload(l.point_body);
  surface.env.upload(l.point_env);
  std::vector<Index> body_env;
  for (const Body& b : bodies) body_env.push_back(b.env);
  surface.pairs = geometry::BodyPairs(body_env);
  surface.pair_allowed.upload(std::vector<std::uint8_t>(surface.pairs.size(0), 0));
}

}  // namespace

void build(Model& model) {
  Layout l;
  std::vector<Index> tet_env;
  for (const BodyInput& in : model.input.bodies) {
    if (in.type == BodyType::half_space) {
      model.half_spaces.push_back({in.name, in.params.vec3("point"), in.params.vec3("normal").normalized()});
      continue;
    }
    add_body(l, model, in);
    tet_env.resize(l.tets.size(), in.env);
    model.envs = std::max<Index>(model.envs, in.env + 1);
  }
  if (model.bodies.empty()) throw Error(Exit::scene, model.input.scene.where(), "the scene has no body that can move or be pressed");

  for (std::size_t p = 0; p + 1 < l.point_offset.size(); ++p)
    if (l.point_offset[p + 1] - l.point_offset[p] > kPointTerms)
      throw Error(Exit::internal, "a point hangs on more than " + std::to_string(kPointTerms) + " blocks");
  model.blocks = static_cast<Index>(l.rest.size());
  model.points = static_cast<Index>(l.points.size());
  model.env_blocks = offsets_by_env(l.block_env, model.envs);
  model.env_points = offsets_by_env(l.point_env, model.envs);
  model.env_bodies.assign(model.envs + 1, 0), model.env_cells = model.env_bodies;
  for (const Body& b : model.bodies) {
    ++model.env_bodies[b.env + 1];
    model.env_cells[b.env + 1] += b.type == BodyType::soft ? b.tet_end - b.tet_begin : b.triangle_end - b.triangle_begin;
  }
  for (Index e = 0; e < model.envs; ++e) model.env_bodies[e + 1] += model.env_bodies[e], model.env_cells[e + 1] += model.env_cells[e];
  model.rest.upload(l.rest);
  model.q.upload(l.rest);
  model.initial_velocity.upload(l.velocity);
  model.block_env.upload(l.block_env);
  model.point_offset.upload(l.point_offset);
  model.point_block.upload(l.point_block);
  model.point_weight.upload(l.point_weight);
  model.rest_points.upload(l.points);

  Volume& v = model.volume;
  v.tets.upload(l.tets);
  if (!l.faces.empty()) {
    v.midsides.upload(l.midsides);
    model.faces.nodes.upload(l.faces);
    model.faces.quarter.upload(l.quarter);
  }
  v.first_point.upload(l.first_point);
  v.dm_inverse.upload(l.dm_inverse);
  v.rest_volume.upload(l.rest_volume);
  v.lame_mu.upload(l.mu);
  v.lame_lambda.upload(l.lambda);
  v.mean_lambda.upload(l.mean_lambda);
  v.material.upload(l.material);
  v.env_offset = offsets_by_env(tet_env, model.envs);

  upload_clusters(l.clusters, l.tets.size(), model.envs, model.clusters);
  upload_mass(l, model.mass, model.blocks);
  upload_surface(l, model.surface, model.bodies);
  model.projector.upload(std::vector<Mat3>(model.blocks, Mat3::Identity()));
  model.target.upload(l.rest);
  model.held.assign(model.blocks, 0);
}

std::vector<Index> select_points(const Model& model, const Body& body, const Params& where) {
  const std::vector<Vec3> rest = model.rest_points.download();
  std::vector<Index> out = select(points_of(body, rest), where);
  for (Index& i : out) i += body.point_begin;
  return out;
}

}  // namespace mortise::model
