#include "render/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "quad.h"
#include "render/colour_map.h"
#include "render/overlay.h"

namespace mortise::render {
namespace {

using namespace test;

double brightness(const std::uint8_t* p) { return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]; }

class Drawing : public testing::Test {
 protected:
  void SetUp() override {
    if (MORTISE_RENDER_MODULE == 0) GTEST_SKIP() << "built without the drawing module";
  }
};

TEST(NoDrawingModule, IsSaidClearly) {
  if (MORTISE_RENDER_MODULE != 0) GTEST_SKIP() << "the drawing module is there";
  try {
    Renderer renderer;
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::device);
    EXPECT_NE(std::string(e.what()).find("libmortise_render.so"), std::string::npos);
  }
}

TEST_F(Drawing, SphereCoversItsProjection) {
  DrawMesh sphere = ball({0, 0, 0}, 1);
  sphere.materials[0].colour = {0.8, 0.05, 0.05};
  RenderJob job = job_from(5);
  Renderer renderer;
  const Image empty = renderer.draw(job);
  job.meshes = {{&sphere, {}}};
  const Blob blob = difference(renderer.draw(job), empty);
  // The rim is seen at sin(angle) = radius / distance.
  const double focal = 0.5 * job.height / std::tan(0.5 * job.camera.fov), rim = focal * std::tan(std::asin(1.0 / 5));
  EXPECT_NEAR(blob.pixels / (M_PI * rim * rim), 1, 0.03);
  EXPECT_NEAR(blob.x, 100, 0.3);
  EXPECT_NEAR(blob.y, 60, 0.3);
}

TEST_F(Drawing, OffCentreObjectsLandWhereTheCameraModelSays) {
  const DrawMesh sphere = ball({0.8, 0, 0.4}, 0.05);
  RenderJob job = job_from(5);
  Renderer renderer;
  const Image empty = renderer.draw(job);
  job.meshes = {{&sphere, {}}};
  const Blob blob = difference(renderer.draw(job), empty);
  const double focal = 0.5 * job.height / std::tan(0.5 * job.camera.fov);
  EXPECT_NEAR(blob.x, 100 + focal * 0.8 / 5, 0.5);
  EXPECT_NEAR(blob.y, 60 - focal * 0.4 / 5, 0.5);
}

TEST_F(Drawing, TexturesStandUpright) {
  auto picture = std::make_shared<Texture>(Texture{64, 64, std::vector<std::uint8_t>(64 * 64 * 4, 255)});
  const int quadrant[4][3] = {{230, 20, 20}, {20, 200, 20}, {20, 20, 230}, {230, 210, 20}};  // top left, top right, bottom left, bottom right
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) picture->rgba[4 * (y * 64 + x) + c] = static_cast<std::uint8_t>(quadrant[(y >= 32) * 2 + (x >= 32)][c]);
  DrawMesh square = quad();
  square.materials[0].colour = {1, 1, 1};
  square.materials[0].texture = picture;
  RenderJob job = job_from(5);
  job.meshes = {{&square, {}}};
  const Image image = Renderer().draw(job);
  for (int q = 0; q < 4; ++q) {
    const std::uint8_t* p = image.at(q % 2 == 0 ? 80 : 120, q < 2 ? 40 : 80);
    for (int c = 0; c < 3; ++c) {
      if (quadrant[q][c] > 100)
        EXPECT_GT(p[c], 110) << "quadrant " << q << " channel " << c;
      else
        EXPECT_LT(p[c], 90) << "quadrant " << q << " channel " << c;
    }
  }
}

TEST_F(Drawing, MaterialsFollowTheirTriangles) {
  DrawMesh square = quad();
  square.materials.resize(2);
  square.materials[0].colour = {0.9, 0.02, 0.02}, square.materials[1].colour = {0.02, 0.02, 0.9};
  square.material = {1, 0};  // lower right half blue, upper left half red
  RenderJob job = job_from(5);
  job.meshes = {{&square, {}}};
  const Image image = Renderer().draw(job);
  EXPECT_GT(image.at(120, 85)[2], 2 * image.at(120, 85)[0]);
  EXPECT_GT(image.at(80, 35)[0], 2 * image.at(80, 35)[2]);
}

TEST_F(Drawing, ScalarsTakeTheColoursOfTheBar) {
  DrawMesh square = quad();
  RenderJob job = job_from(5);
  job.bar = ColourBar{"pressure", "kPa", 0, 20e3, 1e-3};
  const ColourMap map = map_for(0, 20e3);
  Renderer renderer;
  for (const double value : {0.0, 10e3, 20e3, 90e3}) {
    job.meshes = {{&square, std::vector<double>(4, value)}};
    const Image image = renderer.draw(job);
    const int i = static_cast<int>(std::lround(255 * std::min(1.0, value / 20e3)));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.at(100, 60)[c], 0.9 * map[3 * i + c] + 10, 0.1 * map[3 * i + c] + 14) << value;
    // A fixed place of the bar keeps its colour: the picture does not shade it.
    const BarBox box = bar_box(job.width, job.height);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(image.at(box.left + 1, box.top)[c], map[3 * 255 + c]);
      EXPECT_EQ(image.at(box.left + 1, box.top + box.height - 1)[c], map[c]);
    }
  }
}

TEST_F(Drawing, NothingIsWrittenWhereTheCameraSaysSo) {
  RenderJob job = job_from(5);
  const Image plain = Renderer().draw(job);
  job.bar = ColourBar{"pressure", "kPa", 0, 20e3, 1e-3}, job.caption = "t = 1 s";
  EXPECT_NE(Renderer().draw(job).rgb, plain.rgb);
  job.annotated = false;
  EXPECT_EQ(Renderer().draw(job).rgb, plain.rgb);
}

TEST_F(Drawing, FisheyeIsEquidistant) {
  RenderJob job = job_from(0);
  job.width = job.height = 240;
  job.camera.position = {0, 0, 0}, job.camera.look_at = {0, 1, 0};
  job.camera.model = Camera::Model::fisheye;
  job.camera.fov = 200 * M_PI / 180;
  Renderer renderer;
  const Image empty = renderer.draw(job);
  EXPECT_EQ(brightness(empty.at(2, 2)), 0);  // outside the image circle
  EXPECT_GT(brightness(empty.at(120, 4)), 20);
  const double focal = 120 / (0.5 * job.camera.fov);
  for (const double degrees : {0.0, 30.0, 44.0, 60.0, 90.0})
    for (const double turn : {0.0, 90.0, 180.0, 270.0, 40.0}) {
      const double theta = degrees * M_PI / 180, phi = turn * M_PI / 180;
      const DrawMesh sphere = ball(3 * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)), 0.15);
      job.meshes = {{&sphere, {}}};
      const Blob blob = difference(renderer.draw(job), empty);
      EXPECT_GT(blob.pixels, 20) << degrees << " " << turn;
      EXPECT_NEAR(blob.x, 120 + focal * theta * std::cos(phi), 1.0) << degrees << " " << turn;
      EXPECT_NEAR(blob.y, 120 - focal * theta * std::sin(phi), 1.0) << degrees << " " << turn;
    }
}

TEST_F(Drawing, FisheyeSeesBehindItself) {
  RenderJob job = job_from(0);
  job.width = job.height = 240;
  job.camera.position = {0, 0, 0}, job.camera.look_at = {0, 1, 0};
  job.camera.model = Camera::Model::fisheye;
  job.camera.fov = 2 * M_PI;
  const double theta = 160 * M_PI / 180;
  DrawMesh sphere = ball(3 * Vec3(std::sin(theta), std::cos(theta), 0), 0.3);
  sphere.materials[0].colour = {0.7, 0.01, 0.01};
  Renderer renderer;
  const Image empty = renderer.draw(job);
  job.meshes = {{&sphere, {}}};
  const Blob blob = difference(renderer.draw(job), empty);
  EXPECT_GT(blob.pixels, 20);
  EXPECT_NEAR(blob.x, 120 + 120 * theta / M_PI, 2.5);
  EXPECT_NEAR(blob.y, 120, 1.5);
}

TEST_F(Drawing, ObjectsShadeTheGround) {
  const DrawMesh sphere = ball({0, 0, 1.5}, 1);
  RenderJob job = job_from(10);
  job.camera.position = {0, -8, 6};
  job.planes = {GroundPlane{{0, 0, 0}}};
  Renderer renderer;
  job.meshes = {{&sphere, {}}};
  const Image with = renderer.draw(job);
  // The key light comes from the upper left behind the camera, so the shadow lies to the right of the ball.
  EXPECT_LT(brightness(with.at(125, 57)), 0.8 * brightness(with.at(45, 57)));
  EXPECT_GT(brightness(with.at(165, 57)), 0.95 * brightness(with.at(45, 57)));
}

TEST_F(Drawing, IsDeterministic) {
  const DrawMesh sphere = ball({0, 0, 1}, 1);
  RenderJob job = job_from(6);
  job.meshes = {{&sphere, std::vector<double>(sphere.points.size(), 0.3)}};
  job.planes = {GroundPlane{}};
  job.bar = ColourBar{};
  job.caption = "t = 0.1 s";
  Renderer one, two;
  const Image first = one.draw(job);
  EXPECT_EQ(first.rgb, one.draw(job).rgb);
  EXPECT_EQ(first.rgb, two.draw(job).rgb);
}

TEST_F(Drawing, PlaceInTheWorldDoesNotMatter) {
  DrawMesh sphere = ball({0, 0, 0}, 1e-3);
  RenderJob job = job_from(5e-3);
  Renderer renderer;
  job.meshes = {{&sphere, {}}};
  const Image here = renderer.draw(job);
  const Vec3 shift(1000, -3000, 500);
  for (Vec3& p : sphere.points) p += shift;
  job.camera.position += shift, job.camera.look_at += shift;
  EXPECT_LT(difference(here, renderer.draw(job)).pixels, 20);
}

TEST_F(Drawing, RefusesCamerasThatSeeNothing) {
  Renderer renderer;
  RenderJob job = job_from(1);
  job.camera.up = {0, 1, 0};
  EXPECT_THROW(renderer.draw(job), Error);
  job = job_from(1);
  job.camera.fov = 3.2;
  EXPECT_THROW(renderer.draw(job), Error);
  job = job_from(1);
  job.width = 0;
  EXPECT_THROW(renderer.draw(job), Error);
}

}  // namespace
}  // namespace mortise::render
