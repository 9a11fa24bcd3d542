#pragma once
// Better values at nodes than those of single elements, as sums over points of integration: of linear tetrahedra the average over those around,
// weighted by volume; of quadratic ones polynomials of second order, fitted to the points around each corner (Zienkiewicz, Zhu, Int. J. Numer. Meth.
// Engng 33, 1992), of which the middle of an edge has the mean of both ends'.
#include <vector>

#include "model/model.h"

namespace mortise::effects::elasticity {

struct Recovery {
  std::vector<Index> first{0}, point;  // blocks + 1; points of integration
  std::vector<double> weight;
  explicit Recovery(const model::Model& model);
  // The same sums by points.
  Recovery transposed(Index points) const;

 private:
  Recovery() = default;
};

}  // namespace mortise::effects::elasticity
