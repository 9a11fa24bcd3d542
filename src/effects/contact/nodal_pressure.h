#pragma once
// Pressure of the points of surfaces: what presses a point, over the area that it stands for,
//     p_i = |f_i| / A_i,   A_i = sum_T (n_T . u) |T| / 3,   u = -f_i / |f_i|                     [Pa]
// over the triangles T around i, as they stand now, that face the force, compared with the best of them (tuning::kFaces): the other sides of a body
// do not. The whole of a triangle counts, however little of it is in contact, so that pressures times areas add up to the force.
#include <vector>

#include "geometry/surface.h"

namespace mortise::effects::contact {

struct NodalPressure {
  std::vector<double> pressure, area;  // p_i [Pa] and A_i [m^2]; 0 where no force is
};

// y: where points are [m]; f: force on each [N], three per point; 0 where there is none. covered: what A_i is at most [m^2], where that is not 0; may
// be empty.
NodalPressure nodal_pressure(const geometry::Surface& surface, const std::vector<Vec3>& y, const std::vector<double>& f,
                             const std::vector<double>& covered = {});

}  // namespace mortise::effects::contact
