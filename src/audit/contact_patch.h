#pragma once
// Where contact presses on soft surfaces, node by node: what estimates of its errors look at.
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

class ContactPatch {
 public:
  explicit ContactPatch(const model::ModelInput& input);

  struct Node {
    std::size_t point;
    std::vector<Index> ring;  // corners of the triangles around it that are pressed, without itself
    Vec3 normal;              // a third of those triangles as they stand now, as vectors [m^2],
    double area;              // and as areas
    bool inside;              // what is pressed around it is covered
    // What a pressure p over them loads it with, inside: sum of weight times p at node, int N_i p dA with the areas as they stand now [m^2]. Nothing
    // where faces around it reach beyond the patch, or beyond what presses on them.
    std::vector<std::pair<Index, double>> load;
  };
  // Of all points: contact_pressure [Pa], contact_force [N] and displacement [m], three each, contact_area [m^2]; the last two may be empty.
  struct Fields {
    std::span<const double> pressure, force, displacement, area = {};
  };
  // Nodes that are covered: they carry pressure, or most of their neighbours do, as where a method leaves out every other one. A body's own edge is
  // no rim: triangles around the corner are not pressed.
  std::vector<Node> covered(const Fields& fields) const;
  std::vector<Node> interior(const Fields& fields) const;  // those inside
  long loaded(std::span<const double> pressure) const;     // nodes that carry pressure

  const std::vector<Vec3>& rest() const { return rest_; }             // of all points [m]
  std::size_t body(std::size_t point) const { return body_[point]; }  // by number, of those that have points

 private:
  // Facets around node i that are pressed: the one that faces the force most, and those that go on from it without an edge of the body between them.
  // normal: of all facets, times twice their area.
  std::vector<Index> sheet(std::size_t i, const Vec3& force, const std::vector<Vec3>& normal) const;
  // Of node i, over the facets around it that are pressed.
  void load(std::size_t i, const std::vector<Index>& pressed, const std::vector<Vec3>& normal, std::vector<std::pair<Index, double>>& out) const;

  std::vector<Vec3> rest_;
  std::vector<std::size_t> body_;  // of every point
  struct Facet {
    Triangle corners;
    Index face = -1;  // the face of a quadratic tetrahedron that it is a quarter of
  };
  std::vector<Facet> facets_;                // of soft bodies
  std::vector<std::array<Index, 6>> faces_;  // their points, of quadratic bodies
  std::vector<std::vector<Index>> around_;   // per point: facets; none off soft surfaces
};

}  // namespace mortise::audit
