#include "importers/robot/fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "geometry/bounds.h"
#include "importers/robot/inertial.h"
#include "importers/robot/solid.h"
#include "importers/robot/weigh.h"

namespace mortise::importers {
namespace {

void fit(Shape& s) {
  const Inertial in = inertial_of(s, 1);
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(in.tensor);  // moments ascend: the least is about the longest axis
  Mat3 R;
  R.col(2) = eigen.eigenvectors().col(0), R.col(1) = eigen.eigenvectors().col(1), R.col(0) = R.col(1).cross(R.col(2));
  const Vec3 I(eigen.eigenvalues()[2], eigen.eigenvalues()[1], eigen.eigenvalues()[0]);
  // A box of unit mass has I_x = (h_y^2 + h_z^2) / 3, h: half its sides.
  Vec3 half = (1.5 * (Vec3::Constant(I.sum()) - 2 * I)).cwiseMax(0).cwiseSqrt(), centre = in.centre;
  if (s.fit_box) {
    geometry::Bounds box;
    for (const Vec3& x : surface(s, s.at).points) box.include(R.transpose() * (x - in.centre));
    half = 0.5 * box.size(), centre += R * (0.5 * (box.lo + box.hi));
  }
  half *= s.fit_scale;
  const double across = s.fit_box ? std::max(half[0], half[1]) : 0.5 * (half[0] + half[1]);
  const Shape::Kind kind = *s.fit;
  s.fit.reset(), s.kind = kind, s.at = {R, centre}, s.file.clear(), s.surface.reset(), s.scale = Vec3::Ones();
  s.size = 2 * half, s.radius = across, s.length = 2 * half[2];
  if (kind == Shape::Kind::sphere) s.radius = s.fit_box ? half.maxCoeff() : half.mean();
  // Of a capsule the caps are half within that length, as MuJoCo has them.
  if (kind == Shape::Kind::capsule) s.length = 2 * std::max(half[2] - (s.fit_box ? 1.0 : 0.5) * across, 0.0);
  if (kind == Shape::Kind::capsule && !(s.length > 0)) s.kind = Shape::Kind::sphere;
}

}  // namespace

void fit_primitives(Robot& robot) {
  for (Link& link : robot.links)
    for (std::vector<Shape>* shapes : {&link.visuals, &link.collisions})
      for (Shape& s : *shapes) {
        if (!s.fit || s.kind != Shape::Kind::mesh) continue;
        robot.read_surface(s);
        fit(s);
      }
}

}  // namespace mortise::importers
