#pragma once
// How much elastic energy a soft body has, as a measure to hold others against: Hooke's law of Green's strain G in every tetrahedron, of a quadratic
// one at its points of integration,
//     U = sum V (mu |G|^2 + lambda/2 (tr G)^2),
// with nu = 0.4 at most, as single elements near nu = 1/2 have volumes that mean nothing.
#include <array>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

class StrainEnergy {
 public:
  // A place within a tetrahedron, by its barycentrics, and the share of its volume that it stands for.
  struct Place {
    std::size_t tet;
    std::array<double, 4> l;
    double share;
  };
  // `first`: number of the body's first point among all.
  StrainEnergy(const model::BodyInput& body, std::size_t first);
  // Of these places alone.
  StrainEnergy(const model::BodyInput& body, std::size_t first, const std::vector<Place>& places);
  double at(const std::vector<double>& points) const;  // [J]

 private:
  // The nodes of a tetrahedron, four or ten, and what a place makes of them: F = sum x_k g_k^T.
  struct Point {
    std::size_t tet;
    std::vector<Vec3> slopes;  // g [1/m]
    double volume;             // that it stands for [m^3]
  };
  std::size_t first_;
  double mu_ = 0, lambda_ = 0;
  std::vector<std::vector<std::size_t>> nodes_;  // of every tetrahedron
  std::vector<Point> points_;
};

}  // namespace mortise::audit
