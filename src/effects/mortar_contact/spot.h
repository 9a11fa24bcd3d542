#pragma once
// A point of a face, and how it moves with its barycentrics.
#include "effects/mortar_contact/view.h"

namespace mortise::effects::mortar {

struct Spot {
  double shape[6], by[2][6];  // S, dS / d(barycentric)
  Vec3 x[2];                  // dx / d(barycentric)
  MORTISE_HD Spot(const FaceNodes& on, const double at[3], View<const Vec3> y) {
    on.shape(at, shape);
    on.slope(at, by[0], by[1]);
    for (int j = 0; j < 2; ++j) {
      x[j] = Vec3::Zero();
      for (int k = 0; k < on.count; ++k) x[j] += by[j][k] * y[on.point[k]];
    }
  }
};

}  // namespace mortise::effects::mortar
