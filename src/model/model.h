#pragma once
// The discrete problem: degrees of freedom, bodies, meshes, mass, supports. Built once from a ModelInput; effects read it,
// the solver moves q. All degrees of freedom are 3-vectors ("blocks"): a soft node is one block; a stiff body is an affine
// body of four blocks (p, a1, a2, a3), so that its material point X = (X1,X2,X3), measured from the rest centre of mass, sits
// at y = p + X1 a1 + X2 a2 + X3 a3. At rest p is the centre of mass and (a1,a2,a3) the identity.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/params.h"
#include "device/device.h"
#include "geometry/surface.h"
#include "model/input.h"
#include "model/joints.h"
#include "model/ties.h"

namespace mortise::geometry {
class Broadphase;
}

namespace mortise::model {

using device::Buffer;
using device::View;

struct Body {
  std::string name;
  BodyType type = BodyType::soft;
  Index env = 0;
  Index block_begin = 0, block_end = 0;        // degrees of freedom
  Index point_begin = 0, point_end = 0;        // points: soft nodes or stiff vertices
  Index tet_begin = 0, tet_end = 0;            // soft only
  Index triangle_begin = 0, triangle_end = 0;  // surface triangles
  double mass = 0;                             // [kg]
  double volume = 0;                           // [m^3]
  Vec3 centre = Vec3::Zero();                  // rest centre of mass [m]
  double youngs_modulus = 0, poisson_ratio = 0, density = 0;
  Index carriage = kFree;  // whose path prescribes all of it at all times: bodies of one carriage move as one
  bool stays = false;      // soft: supports hold three of its points, not on a line, for good and never turn them
  SourceLoc where;
  static constexpr Index kFree = -1, kStill = 0;
  bool prescribed() const { return carriage != kFree; }
};

// y = sum_k weight * q[block]: one term for a soft node, four for a point of a stiff body; never more, because blocks that are tied to others
// remain blocks (model/ties.h).
inline constexpr Index kPointTerms = 4;
struct PointMapView {
  View<const Index> offset;  // points + 1
  View<const Index> block;
  View<const double> weight;
};

// Tetrahedra of all soft bodies, linear or quadratic, and the points that integrate over them: one of a linear tetrahedron, four of
// a quadratic one (geometry/quadratic.h).
struct Volume {
  Buffer<Tet> tets;                     // block ids of the corners
  Buffer<geometry::Midsides> midsides;  // of the middles of edges, -1 in linear tetrahedra; empty where all are linear
  Buffer<Index> first_point;            // elements + 1
  Buffer<Mat3> dm_inverse;              // per point: inverse of dX/d(l1, l2, l3) at rest [1/m]
  Buffer<double> rest_volume;           // per point: its share of the volume [m^3]
  // Per element [Pa]. lambda, which resists changes of volume, acts at every point; in nearly incompressible bodies on the mean over a quadratic
  // tetrahedron or over a cluster of linear ones instead.
  Buffer<double> lame_mu, lame_lambda, mean_lambda;
  Buffer<std::uint8_t> material;  // MaterialModel
  std::vector<Index> env_offset;
};

// Clusters of linear tetrahedra that resist a change of their volume together (model/clusters.h).
struct Clusters {
  Buffer<Index> of_tet;                            // per element, -1: none; empty where there are no clusters
  Buffer<Index> first_tet, tet;                    // clusters + 1; their elements
  Buffer<Index> slot;                              // four per entry of `tet`: the entries of its corners in `node`
  Buffer<Index> first_node, node;                  // clusters + 1; their block ids, each once
  Buffer<Index> owner;                             // cluster of every entry of `node`
  Buffer<double> lambda, volume;                   // [Pa], [m^3]
  std::vector<Index> env_offset{0}, env_nodes{0};  // the first cluster, and the first entry of `node`, of every environment
  Index size() const { return lambda.size(); }
};

// Symmetric mass matrix M (x) I3 as rows of scalars, both triangles [kg].
struct Mass {
  Buffer<Index> row_offset, column;
  Buffer<double> value;
};

// Quadratic faces of the surface. The triangles of geometry::Surface are their quarters (geometry/quadratic.h); what acts on the surface
// spreads its forces over the six nodes. Empty where all bodies are linear.
struct QuadraticFaces {
  Buffer<geometry::Face> nodes;  // point ids
  Buffer<Index> quarter;         // per triangle: 4 face + quarter, or -1 for a triangle of its own
};

// An analytic obstacle: the material side is below the plane through `point` with unit outward normal.
struct HalfSpace {
  std::string name;
  Vec3 point, normal;
};

class Model {
 public:
  explicit Model(ModelInput input);
  ~Model();
  Model(const Model&) = delete;

  ModelInput input;  // the scene and the meshes it was built from
  std::vector<Body> bodies;
  std::vector<HalfSpace> half_spaces;

  Index blocks = 0, points = 0, envs = 1;
  std::vector<Index> env_blocks;  // offsets: environment e owns blocks [env_blocks[e], env_blocks[e+1]),
  std::vector<Index> env_points, env_bodies;
  std::vector<Index> env_cells;   // of output: tetrahedra of soft bodies, surface triangles of stiff ones, body after body
  Buffer<Vec3> rest;              // q at rest
  Buffer<Vec3> q;                 // q at the last accepted state
  Buffer<Vec3> initial_velocity;  // per block, from the scene [m/s]
  Buffer<Index> block_env;

  Buffer<Index> point_offset, point_block;
  Buffer<double> point_weight;
  Buffer<Vec3> rest_points;  // y at rest
  PointMapView point_map() const { return {point_offset.view(), point_block.view(), point_weight.view()}; }
  // y = W q, for positions and (being linear) for displacements alike.
  void points_of(View<const Vec3> q, Buffer<Vec3>& y) const;

  Volume volume;
  Clusters clusters;
  Mass mass;
  geometry::Surface surface;
  QuadraticFaces faces;

  // Supports: block b may move only within the range of projector[b] (symmetric, 3x3; identity = free, zero = held) and is
  // asked to be at target[b] in the held directions. `held` on the host: 0 free, 1 partly, 2 fully held, 3 tied to others (its projector is
  // that of a free one).
  Buffer<Mat3> projector;
  Buffer<Vec3> target;
  std::vector<std::uint8_t> held;
  static constexpr std::uint8_t kTied = 3;
  Ties ties;
  std::vector<Joint> joints;
  bool driven = false;  // some support moves

  // The environments that are worked on. The others stand still: kernels leave them out, and what is known of them stays as it was, or is not known
  // any more where it is kept in lists of what is there now (contact). Empty: all. Set by Only.
  mutable std::vector<std::uint8_t> at_work;
  bool works_on(Index env) const { return at_work.empty() || at_work[env] != 0; }
  device::Ranges working(const std::vector<Index>& offset) const { return {offset, at_work}; }

  // One candidate search for all contact effects, built by the first that asks.
  geometry::Broadphase& broadphase();
  // Makes contact watched between two bodies (or within one) where the table (of surface.pairs) is not zero.
  void watch(const std::vector<std::uint8_t>& pairs);

  // Contact effects, by name: what followers find.
  void add_contact(std::string_view effect) { contacts_.emplace_back(effect); }
  bool has_contact(std::string_view effect) const;

  // Bodies of that name, one of every environment that has it; or the number of bodies plus the index of the half-space of that name; none.
  std::vector<Index> bodies_named(std::string_view name) const;
  // What the number of a body, or the number of bodies plus that of a half-space, is where its environment is alone.
  Index number_alone(Index body, Index env) const {
    const auto all = static_cast<Index>(bodies.size());
    return body < all ? body - env_bodies[env] : env_bodies[env + 1] - env_bodies[env] + (body - all);
  }
  // Body or half-space `b` may meet body `a`: half-spaces are in all environments.
  bool same_env(Index a, Index b) const { return b >= static_cast<Index>(bodies.size()) || bodies[a].env == bodies[b].env; }

 private:
  std::unique_ptr<geometry::Broadphase> broadphase_;
  std::vector<std::string> contacts_;
};

// Work goes on in the environments of `whose` only, as long as this lives.
class Only {
 public:
  Only(const Model& model, const std::vector<std::uint8_t>& whose) : model_(model), before_(model.at_work) {
    const bool all = std::find(whose.begin(), whose.end(), 0) == whose.end();
    model_.at_work = all ? std::vector<std::uint8_t>{} : whose;
  }
  ~Only() { model_.at_work = std::move(before_); }
  Only(const Only&) = delete;
  Only& operator=(const Only&) = delete;

 private:
  const Model& model_;
  std::vector<std::uint8_t> before_;
};

// Point ids of `body` that satisfy a `where` block of the scene ({side: ...}, {box: ...}, ...), tested on rest positions.
std::vector<Index> select_points(const Model& model, const Body& body, const Params& where);

}  // namespace mortise::model
