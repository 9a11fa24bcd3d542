#pragma once
// The contact terms that act at a position: candidates within range, with equal terms of the alternating sum (pair_energy.h) merged.
#include <optional>

#include "device/room.h"
#include "effects/contact/candidates.h"
#include "effects/contact/pair_energy.h"
#include "effects/curvature.h"
#include "linalg/stencils.h"
#include "model/contact_view.h"
#include "model/model.h"

namespace mortise::effects::contact {

enum class TermKind : Index { vertex, edge, triangle, edge_edge, plane };

struct Active {
  TermKind kind;
  Index env;
  Index point[4];  // the point first, or the two edges; -1 where unused
  Index plane;
  Index open = 0;  // what would be padding: copies read it too
  double weight;   // [m^2]; may be negative where the alternating sum is
  double eps;      // mollifier threshold [m^4], 0 without
};

struct ActiveSet {
  Buffer<Active> terms;  // environments contiguous, then points by id, then edge pairs, then half-spaces
  std::vector<Index> env_offset;
  linalg::StencilSizes sizes;  // of the stencils of all terms, where they were shaped
};

// Room for point-triangle pairs in range and for terms, among so many surface vertices.
struct TermRoom {
  device::Room hits, terms;
};

// What the terms are to be found among, and for whom.
struct Where {
  Candidates& candidates;                  // all of them are there afterwards
  const Buffer<Vec3>& y;                   // of the points
  const std::vector<std::uint8_t>& whose;  // environments, or empty: all
  device::Ranges vertices;                 // their surface vertices
};

// Contact areas (pair_energy.h) as bodies stand at y: towards every half-space, and towards the contacts of `set` for the points in them.
void face_planes(const BarrierView& s, View<const Vec3> y, View<double> plane_area);
void face_points(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, View<double> point_area);

// Adds the energy of environment e to per_env[e]; +infinity where anything touches, or positions are not numbers. What `at` refers to, but for the
// environments and ranges, must stay until the fetch is done.
void energy(const BarrierView& s, const Where& at, device::EnvValues per_env);

struct PointTerms {
  Buffer<std::uint64_t> key;       // sorted
  Buffer<Index> start, sum, kept;  // where its runs begin; coefficient of each; offsets of those that are terms
};

// The terms. The host waits once, as a rule.
void build(const BarrierView& s, const Where& at, TermRoom& room, ActiveSet& out);
// And the shape of their stencils over the blocks of `map`.
void build(const BarrierView& s, const Where& at, TermRoom& room, const model::PointMapView& map, ActiveSet& out, linalg::StencilSet& stencils);

// That in two halves, between which a fetch brings what only the device counts; false: candidates were missing or the room was too small, which they
// are no more.
class TermSearch {
 public:
  // map, stencils: for their shape, or null. What is referred to must stay until the end.
  void begin(const BarrierView& s, const Where& at, const TermRoom& room, const model::PointMapView* map, ActiveSet& out,
             linalg::StencilSet* stencils, device::Fetch& fetch);
  bool end(TermRoom& room);

 private:
  std::optional<Where> where_;
  Candidates::Look look_;
  ActiveSet* out_ = nullptr;
  PointTerms found_;
  Buffer<Index> points_at_, edges_at_, planes_at_;        // offsets of the candidates in range
  Index hits_ = 0, points_ = 0, edges_ = 0, planes_ = 0;  // how many there are: in range, and terms
  Index most_ = 0, places_ = 0;                           // and were expected
};
// The stencils of the terms, of which a search has brought the shape.
void shape(ActiveSet& set, linalg::StencilSet& stencils);

// Blocks of the stencil of every term, and room for their sum.
void count_blocks(const ActiveSet& set, const model::PointMapView& map, Buffer<Index>& counts);

// Fills the stencils, and finds one sample per term (model/contact_view.h).
void assemble(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, const model::PointMapView& map, Curvature curvature,
              linalg::StencilSet& out);
void samples(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, Buffer<model::ContactSample>& out);

// How the samples change with y: exactly.
void sample_changes(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, model::SampleChanges& out);

// Force on the four points of every term [N]: minus the gradient.
void point_forces(const BarrierView& s, const ActiveSet& set, View<const Vec3> y, Buffer<Vec3>& out);

// Lowers alpha[e] so that every one of the surface vertices keeps the share `keep` of its gap to every half-space (exact: the gap is linear).
void limit_planes(const BarrierView& s, View<const Vec3> y, View<const Vec3> dy, double keep, const device::Ranges& vertices,
                  device::EnvValues alpha);

// The least distance of what is to be kept apart in every environment, of those nearer than the reach of the candidates; farther ones may be among
// them or not, by where the last search was. +infinity where there is nothing. Of a body from itself only what is within its own range counts
// (pair_energy.h).
std::vector<double> least_distances(const BarrierView& s, const Candidates& c, View<const Vec3> y, const std::vector<Index>& vertex_env);

}  // namespace mortise::effects::contact
