#pragma once
// How much elastic energy a soft body has, as a measure to hold others against: Hooke's law of Green's strain G in every tetrahedron (of a quadratic
// one by its corners),
//     U = sum V (mu |G|^2 + lambda/2 (tr G)^2),
// with nu = 0.4 at most, as single elements near nu = 1/2 have volumes that mean nothing.
#include <vector>

#include "model/input.h"

namespace mortise::run {

class StrainEnergy {
 public:
  // `first`: number of the body's first point among all.
  StrainEnergy(const model::BodyInput& body, std::size_t first);
  double at(const std::vector<double>& points) const;  // [J]

 private:
  std::size_t first_;
  double mu_ = 0, lambda_ = 0;
  std::vector<Tet> tets_;
  std::vector<Mat3> inverse_;  // of the edges at rest [1/m]
  std::vector<double> volume_;
};

}  // namespace mortise::run
