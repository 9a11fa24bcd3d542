#pragma once
// Pressure on part of a body's surface as every contact method can give it.
//   Linear tetrahedra: force of a node over its area at rest, along that area's normal.
//   Quadratic tetrahedra: forces at corners are zero or less, whatever the pressure, so contact_pressure it is. It is a force per area now;
//   linear theories, like the bodies' linear law, speak of the area and of the place at rest, and into these it is turned.
#include <functional>
#include <string>
#include <vector>

#include "bench/harness.h"

namespace mortise::bench {

struct Traction {
  std::vector<Vec3> at;           // nodes, where their pressure is compared: now, quadratic: at rest [m]
  std::vector<std::size_t> node;  // of the body
  std::vector<Vec3> now;          // where they are [m]
  std::vector<double> p, area;    // inward normal force over area at rest [Pa], and that area [m^2]
  double force() const;           // sum p area [N]
  double peak() const;
  // ||p - exact|| / ||exact|| over the nodes that `in` selects, weighted with their areas.
  double l2(const std::function<double(const Vec3&)>& exact, const std::function<bool(const Vec3&)>& in) const;
};

// `on`: is this rest position on the part? A triangle belongs to it when its three corners do.
Traction nodal_traction(const Solved& s, const std::string& body, const std::function<bool(const Vec3&)>& on, bool quadratic = false);

// Force-weighted mean of a quantity of the samples' places: moments of the pressure without the error that nodal forces have in them (of
// r^2, interpolated between nodes, about h^2/3 too much).
double sample_mean(const Solved& s, const std::string& effect, const std::function<double(const Vec3&)>& of);

// Force-weighted mean gap of the samples [m].
double mean_gap(const Solved& s, const std::string& effect);

}  // namespace mortise::bench
