#include "render/camera.h"

#include <algorithm>
#include <cmath>

namespace mortise::render {

bool has_pose(const Camera& camera) {
  const Vec3 sight = camera.look_at - camera.position;
  return sight.cross(camera.up).norm() > 1e-9 * sight.norm() * camera.up.norm();
}

Pose pose_of(const Camera& camera) {
  const Vec3 forward = (camera.look_at - camera.position).normalized(), right = forward.cross(camera.up).normalized();
  return {right, forward.cross(right), forward};
}

Intrinsics intrinsics_of(const RenderJob& job) {
  const double focal = job.camera.model == Camera::Model::fisheye ? std::min(job.width, job.height) / job.camera.fov
                                                                  : 0.5 * job.height / std::tan(0.5 * job.camera.fov);
  return {focal, focal, 0.5 * (job.width - 1), 0.5 * (job.height - 1)};
}

std::optional<Vec2> project(const RenderJob& job, const Vec3& point) {
  const Pose pose = pose_of(job.camera);
  const Intrinsics k = intrinsics_of(job);
  const Vec3 d = point - job.camera.position, x(pose.right.dot(d), pose.down.dot(d), pose.forward.dot(d));
  if (job.camera.model == Camera::Model::pinhole) {
    if (!(x[2] > 0)) return std::nullopt;
    return Vec2(k.fx * x[0] / x[2] + k.cx, k.fy * x[1] / x[2] + k.cy);
  }
  const double r = std::hypot(x[0], x[1]), theta = std::atan2(r, x[2]);
  if (theta > 0.5 * job.camera.fov) return std::nullopt;
  const double s = r > 0 ? theta / r : 0;
  return Vec2(k.fx * s * x[0] + k.cx, k.fy * s * x[1] + k.cy);
}

std::optional<Vec3> ray_of(const RenderJob& job, int x, int y) {
  const Pose pose = pose_of(job.camera);
  const Intrinsics k = intrinsics_of(job);
  const double u = (x - k.cx) / k.fx, v = (y - k.cy) / k.fy;
  if (job.camera.model == Camera::Model::pinhole) return pose.forward + u * pose.right + v * pose.down;
  const double theta = std::hypot(u, v);
  if (theta > 0.5 * job.camera.fov) return std::nullopt;
  const double s = theta > 0 ? std::sin(theta) / theta : 1;
  return std::cos(theta) * pose.forward + s * (u * pose.right + v * pose.down);
}

}  // namespace mortise::render
