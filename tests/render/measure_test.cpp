// Distances and bodies per pixel against rays that are followed exactly.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "quad.h"
#include "render/camera.h"
#include "render/renderer.h"

namespace mortise::render {
namespace {

using namespace test;

class Measuring : public testing::Test {
 protected:
  void SetUp() override {
    if (MORTISE_RENDER_MODULE == 0) GTEST_SKIP() << "built without the drawing module";
  }
};

// How far along `ray` from the camera a mesh is hit first, infinite where it is not; `margin`: by how much of a triangle the ray stays clear of its
// edges.
double follow(const DrawMesh& mesh, const Vec3& from, const Vec3& ray, double& margin) {
  double first = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {
    Mat3 m;
    m << mesh.points[t.v[1]] - mesh.points[t.v[0]], mesh.points[t.v[2]] - mesh.points[t.v[0]], -ray;
    const Vec3 x = m.inverse() * (from - mesh.points[t.v[0]]);
    const double inside = std::min({x[0], x[1], 1 - x[0] - x[1]});
    if (inside > 0 && x[2] > 0 && x[2] < first) first = x[2];
    margin = std::min(margin, std::abs(inside));
  }
  return first;
}

TEST_F(Measuring, APinholeSeesDepthAlongItsLineOfSight) {
  DrawMesh sphere = ball({0.3, 0.2, 0.1}, 1);
  RenderJob job = job_from(5);
  job.camera.position = {1, -5, 2};
  job.meshes = {Drawn{&sphere, {}, 7}};
  const Measurement seen = Renderer().measure(job);
  ASSERT_EQ(seen.id.size(), 200u * 120);
  int hits = 0;
  for (int y = 0; y < job.height; y += 3)
    for (int x = 0; x < job.width; x += 3) {
      double margin = 1;
      const double exact = follow(sphere, job.camera.position, *ray_of(job, x, y), margin);
      if (margin < 1e-3) continue;
      const std::size_t i = static_cast<std::size_t>(y) * job.width + x;
      EXPECT_EQ(seen.id[i], std::isfinite(exact) ? 7 : 0) << x << " " << y;
      if (!std::isfinite(exact)) {
        EXPECT_EQ(seen.distance[i], exact);
        continue;
      }
      EXPECT_NEAR(seen.distance[i], exact, 1e-5) << x << " " << y;
      ++hits;
    }
  EXPECT_GT(hits, 300);
}

TEST_F(Measuring, AFisheyeSeesDistancesAlongItsRaysAlsoBehind) {
  RenderJob job = job_from(0);
  job.width = 200, job.height = 160;
  job.camera = {Camera::Model::fisheye, {0.1, -0.2, 0.3}, {0.2, 1, 0.4}, {0, 0.1, 1}, 1.8 * M_PI};
  // Walls of a room, of two triangles each; each is a body.
  const DrawMesh square = quad();
  DrawMesh walls[6];
  for (int k = 0; k < 6; ++k) {
    walls[k] = square;
    const Vec3 n = (k % 2 == 0 ? 1.0 : -1.0) * Vec3::Unit(k / 2), u = n.unitOrthogonal(), v = n.cross(u);
    for (int i = 0; i < 4; ++i) walls[k].points[i] = 2 * (n + square.points[i][0] * u + square.points[i][2] * v), walls[k].normals[i] = -n;
    job.meshes.push_back(Drawn{&walls[k], {}, k + 1});
  }
  const Measurement seen = Renderer().measure(job);
  int inside = 0, wrong = 0;
  for (int y = 0; y < job.height; ++y)
    for (int x = 0; x < job.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * job.width + x;
      const std::optional<Vec3> ray = ray_of(job, x, y);
      if (!ray) {
        EXPECT_EQ(seen.id[i], 0) << x << " " << y;
        continue;
      }
      EXPECT_NEAR(ray->norm(), 1, 1e-12);
      double exact = std::numeric_limits<double>::infinity();
      int id = 0;
      for (int k = 0; k < 6; ++k) {
        const double along = (2 - (k % 2 == 0 ? 1 : -1) * job.camera.position[k / 2]) / ((k % 2 == 0 ? 1 : -1) * (*ray)[k / 2]);
        if (along > 0 && along < exact) exact = along, id = k + 1;
      }
      ++inside;
      if (seen.id[i] != id) {
        ++wrong;  // on the edges of the room the nearest texel decides
        continue;
      }
      EXPECT_NEAR(seen.distance[i] / exact, 1, 0.05) << x << " " << y;
      wrong += std::abs(seen.distance[i] / exact - 1) > 2e-5;
    }
  EXPECT_GT(inside, 19000);
  EXPECT_LT(wrong, 0.05 * inside);  // pixels within a texel of an edge
}

TEST_F(Measuring, PlanesAreExactAndReachToTheHorizon) {
  for (const Camera::Model model : {Camera::Model::pinhole, Camera::Model::fisheye}) {
    RenderJob job = job_from(0);
    job.camera = {model, {0, 0, 2}, {0, 1, 1.9}, {0, 0, 1}, 1.2};
    const DrawMesh sphere = ball({0, 8, 0.3}, 0.2);
    job.meshes = {Drawn{&sphere, {}, 3}};
    GroundPlane ground;
    ground.id = 4;
    job.planes = {ground};
    const Measurement seen = Renderer().measure(job);
    int plane = 0, body = 0;
    for (int y = 0; y < job.height; ++y)
      for (int x = 0; x < job.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * job.width + x;
        const std::optional<Vec3> ray = ray_of(job, x, y);
        body += seen.id[i] == 3;
        plane += seen.id[i] == 4;
        if (!ray || ray->z() >= 0) {
          EXPECT_EQ(seen.id[i], 0);
        } else if (seen.id[i] == 4) {
          EXPECT_NEAR(seen.distance[i] * -ray->z(), 2, 1e-12);
        }
      }
    EXPECT_GT(plane, 4000);
    EXPECT_GT(body, 4);
  }
}

TEST_F(Measuring, TheNearestOfSeveralBodiesCountsWhateverTheirOrder) {
  DrawMesh front = quad(), back = quad();
  for (Vec3& p : back.points) p = 1.5 * p + Vec3(0, 1, 0);
  RenderJob job = job_from(5);
  Renderer renderer;
  for (const bool first : {false, true}) {
    job.meshes = {Drawn{first ? &front : &back, {}, first ? 1 : 2}, Drawn{first ? &back : &front, {}, first ? 2 : 1}};
    const Measurement seen = renderer.measure(job);
    const std::size_t middle = 60 * 200 + 100, above = 18 * 200 + 100;
    EXPECT_EQ(seen.id[middle], 1);
    EXPECT_NEAR(seen.distance[middle], 5, 1e-5);
    EXPECT_EQ(seen.id[above], 2);
    EXPECT_NEAR(seen.distance[above], 6, 1e-5);
  }
}

// The written intrinsics against the drawn picture.
TEST_F(Measuring, IntrinsicsProjectToWhatIsDrawn) {
  for (const Camera::Model model : {Camera::Model::pinhole, Camera::Model::fisheye})
    for (const Vec3& where : {Vec3(0.8, 0, 0.4), Vec3(-0.5, 1, -0.3)}) {
      RenderJob job = job_from(5);
      job.camera.model = model;
      Renderer renderer;
      const Image empty = renderer.draw(job);
      const DrawMesh sphere = ball(where, 0.05);
      job.meshes = {Drawn{&sphere, {}, 1}};
      const Blob blob = difference(renderer.draw(job), empty);
      const Pose pose = pose_of(job.camera);
      const Intrinsics k = intrinsics_of(job);
      const Vec3 d = where - job.camera.position, x(pose.right.dot(d), pose.down.dot(d), pose.forward.dot(d));
      const double r = std::hypot(x[0], x[1]), s = model == Camera::Model::pinhole ? 1 / x[2] : std::atan2(r, x[2]) / r;
      EXPECT_NEAR(blob.x - 0.5, k.fx * x[0] * s + k.cx, 0.5);
      EXPECT_NEAR(blob.y - 0.5, k.fy * x[1] * s + k.cy, 0.5);
    }
}

TEST(Camera, ProjectsWhereItsRaysComeFrom) {
  for (const Camera::Model model : {Camera::Model::pinhole, Camera::Model::fisheye}) {
    RenderJob job = job_from(0);
    job.camera = {model, {0.1, -0.2, 0.3}, {0.2, 1, 0.4}, {0, 0.1, 1}, model == Camera::Model::pinhole ? 1.0 : 5.0};
    int seen = 0;
    for (int y = 0; y < job.height; y += 7)
      for (int x = 0; x < job.width; x += 11) {
        const std::optional<Vec3> ray = ray_of(job, x, y);
        if (!ray) continue;
        const std::optional<Vec2> back = project(job, job.camera.position + 3 * *ray);
        ASSERT_TRUE(back);
        EXPECT_LT((*back - Vec2(x, y)).norm(), 1e-9);
        ++seen;
      }
    EXPECT_GT(seen, 100);
    const Pose pose = pose_of(job.camera);
    EXPECT_FALSE(project(job, job.camera.position - pose.forward)) << "behind";
  }
}

TEST_F(Measuring, ArrowsLieOverWhatHidesThem) {
  const DrawMesh square = quad();
  RenderJob job = job_from(5);
  job.meshes = {Drawn{&square, {}, 1}};
  Renderer renderer;
  const Image empty = renderer.draw(job);
  job.arrows = {
      {{0.3, 2, 0.2}, {0.6, 2, 0.2}}, {{0, 2, 0}, {0, -20, 0}}, {{0, 0, 0}, {1e9, 0, 1e9}}};  // behind the square; to behind the camera; far out
  const Image with = renderer.draw(job);
  const Vec2 from = *project(job, job.arrows[0].from), to = *project(job, job.arrows[0].to);
  const auto white = [&](const Vec2& p) { return with.at(static_cast<int>(std::lround(p[0])), static_cast<int>(std::lround(p[1])))[0]; };
  EXPECT_GT(white(0.5 * (from + to)), 240);
  EXPECT_GT(white(from), 150);
  job.arrows.resize(1);
  const Blob blob = difference(renderer.draw(job), empty);
  EXPECT_NEAR(blob.y + -0.5, from[1], 0.5);
  EXPECT_GT(blob.x, from[0]);
  EXPECT_LT(blob.x, to[0] + 1);
}

TEST_F(Measuring, IsDeterministicAndLeavesPicturesAlone) {
  const DrawMesh sphere = ball({0, 0, 1}, 1);
  RenderJob job = job_from(6);
  job.meshes = {Drawn{&sphere, {}, 1}};
  Renderer one, two;
  const Image before = one.draw(job);
  const Measurement a = one.measure(job), b = two.measure(job);
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(one.draw(job).rgb, before.rgb);
}

}  // namespace
}  // namespace mortise::render
