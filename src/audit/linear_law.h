#pragma once
// How far bodies of the law `linear` have turned for it: its strain is sym(F) - I, that of what turned by R and was stretched by U, F = R U, is U -
// I. Over the tetrahedra of such a body, by energy,
//
//   share^2 = turned / (turned + strained),     turned = sum E V |sym(F) - U|^2,     strained = sum E V |U - I|^2:
//
// the error of strains and stresses where it is small (a slope of 0.1 beside strains of 5 %: 0.1), 1 of a body that only turns, which is stressed by
// nothing else. Quadratic tetrahedra by their corners.
#include <span>
#include <vector>

#include "model/input.h"

namespace mortise::audit {

class LinearLaw {
 public:
  explicit LinearLaw(const model::ModelInput& input);
  // Of the displacement of all points [m], the largest of all bodies that are strained or turned at all (tuning::kCounts); NaN where no body has the
  // law.
  double of(std::span<const double> displacement) const;

 private:
  struct Body {
    std::size_t first_point;
    std::vector<Tet> tets;
    std::vector<Mat3> inverse;   // of the edges at rest [1/m]
    std::vector<double> weight;  // E V [J]
  };
  std::vector<Body> bodies_;
  std::size_t points_ = 0;
};

}  // namespace mortise::audit
