#include "study/smooth_peak.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace mortise::study {
namespace {

// A plane of n x n squares, each cut in two the way its neighbours are not, tilted about x.
struct Plane {
  int n;
  std::vector<Vec3> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<double> area;
  explicit Plane(int squares, double tilt) : n(squares) {
    const auto at = [&](int i, int j) { return static_cast<std::int64_t>(i * (n + 1) + j); };
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) points.emplace_back(i, j * std::cos(tilt), j * std::sin(tilt));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if ((i + j) % 2 == 0)
          triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)}), triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        else
          triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)}), triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    area.assign(points.size(), 0.0);
    for (const auto& t : triangles)
      for (std::int64_t v : t) area[v] += 1.0 / 6;
  }
};

TEST(SmoothPeak, ScatterGoesAndParaboloidsStay) {
  const Plane plane(8, 0.7);
  std::vector<double> field, scattered;
  for (std::size_t v = 0; v < plane.points.size(); ++v) {
    const int i = static_cast<int>(v) / 9, j = static_cast<int>(v) % 9;
    const double bowl = 5 - 0.1 * ((i - 4) * (i - 4) + (i - 4) * (j - 4) + 2 * (j - 4) * (j - 4));
    field.push_back(bowl);
    scattered.push_back(bowl * ((i + j) % 2 ? 1.08 : 0.96));  // less area, more of it: as pressures on such meshes do
  }
  EXPECT_NEAR(smooth_peak(plane.triangles, plane.points, plane.area, field), 5, 1e-12);
  EXPECT_GT(*std::max_element(scattered.begin(), scattered.end()), 5.2);
  EXPECT_NEAR(smooth_peak(plane.triangles, plane.points, plane.area, scattered), 5, 0.1);
}

TEST(SmoothPeak, FewNodesCountThemselves) {
  const Plane plane(1, 0);
  EXPECT_EQ(smooth_peak(plane.triangles, plane.points, plane.area, {1, 2, 7, 3}), 7);
  EXPECT_EQ(smooth_peak(plane.triangles, plane.points, plane.area, {-1, 0, -7, -3}), 0) << "nothing acts there";
}

// What lies beyond an edge of the body bears nothing, and does not draw the pressure at the edge down: planes of symmetry are such edges.
TEST(SmoothPeak, SidesOfABodyAreApart) {
  for (double top : {3.0, 4.0}) {
    Plane plane(8, 0);
    std::vector<double> bowl;
    for (Vec3& x : plane.points) {  // folded along x = 4
      bowl.push_back(x[0] <= 4 ? 5 - 0.2 * (x[0] - top) * (x[0] - top) : 0);
      if (x[0] > 4) x[2] = 4 - x[0], x[0] = 4;
    }
    EXPECT_NEAR(smooth_peak(plane.triangles, plane.points, plane.area, bowl), 5, 1e-12) << 4 - top << " edges from the fold";
  }
}

}  // namespace
}  // namespace mortise::study
