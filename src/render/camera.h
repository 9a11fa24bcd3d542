#pragma once
// How cameras project, in the conventions of OpenCV and of ROS's optical frames: x to the right of the picture, y down, z along the line of sight;
// pixel (0, 0) is the middle of the upper left pixel.
#include <optional>

#include "render/job.h"

namespace mortise::render {

// The camera's axes in the world: unit, orthogonal, right-handed.
struct Pose {
  Vec3 right, down, forward;
};
Pose pose_of(const Camera& camera);
bool has_pose(const Camera& camera);  // it looks somewhere, and not along `up`

// pinhole:  u = fx x/z + cx,  v = fy y/z + cy
// fisheye:  u = fx theta x/r + cx,  v = fy theta y/r + cy,  r = sqrt(x^2 + y^2),  theta = atan2(r, z)   (OpenCV's fisheye model with k1 = ... = k4 =
// 0)
struct Intrinsics {
  double fx, fy, cx, cy;  // [pixels]
};
Intrinsics intrinsics_of(const RenderJob& job);

// Where a point of the world is in the picture [pixels]; nothing where the camera cannot see it: behind a pinhole, outside a fisheye's image circle.
std::optional<Vec2> project(const RenderJob& job, const Vec3& point);

// Where the middle of pixel (x, y) looks in the world: its part along the line of sight is one (pinhole), or it is of length one (fisheye; nothing
// outside the image circle). What is `distance` times this from the camera is what Renderer::measure() measures.
std::optional<Vec3> ray_of(const RenderJob& job, int x, int y);

}  // namespace mortise::render
