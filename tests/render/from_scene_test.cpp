#include "render/from_scene.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "place.h"
#include "scene/scene.h"

namespace mortise::render {
namespace {

const char* kScene = R"(
mortise: 1
time: {mode: static, steps: 1}
materials:
  gel: {model: neo_hookean, youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  a: {type: soft, material: gel, shape: {box: {size: [1, 1, 1], edge_length: 0.5}}, visual: {color: [1, 0, 0], roughness: 0.2}}
  b: {type: soft, material: gel, shape: {mesh: {file: ASSETS/urchin.obj, scale: 2}}, position: [3, 0, 0],
      rotation: {axis: [0, 0, 1], angle: 90 deg}, visual: {mesh: ASSETS/urchin.obj}}
  floor: {type: half_space, point: [0, 0, -1], normal: [0, 0, 2]}
effects: {elasticity: {}}
render:
  width: 320
  height: 200
  background: [0.2, 0.4, 0.6]
  cameras:
    all: {position: [0, -9, 2], look_at: [1, 0, 0], fov: 40 deg}
    map: {position: [0, -9, 2], look_at: [1, 0, 0], model: fisheye, fov: 200 deg, hide: [b, floor], colour_by: contact_pressure,
          range: [0, 20 kPa], unit: kPa, annotate: false, background: [0, 0, 0]}
    free: {position: [0, -9, 2], look_at: [1, 0, 0], colour_by: contact_pressure}
    push: {position: [0, -9, 2], look_at: [1, 0, 0], traction: {length: 0.5, longest: 10 kPa}, hide: [b]}
    free_push: {position: [0, -9, 2], look_at: [1, 0, 0], fov: 40 deg, traction: {of: [contact_force]}}
    riding: {position: [3, 0, 2], look_at: [3, 0, 0], up: [0, 1, 0], rides_on: b}
)";

class SceneViewTest : public testing::Test {
 protected:
  SceneViewTest() {
    std::string text = kScene;
    for (std::size_t k; (k = text.find("ASSETS")) != std::string::npos;) text.replace(k, 6, test_place::kSourceFolder + "/scenes/tactile/assets");
    static const ParamTable none{"effect elasticity", "", {}};
    const std::vector<scene::EffectTable> effects{{"elasticity", "", &none, {"contact_pressure", "contact_force"}}};
    root = scene::read_scene_text(text, "test.yaml", {}, effects).root;
    const geometry::TetMesh box = geometry::box(Vec3(1, 1, 1), 0.5);
    for (const auto& [name, params] : root.at("bodies").entries()) {
      model::BodyInput& body = bodies.emplace_back();
      body.name = name, body.params = params;
      if (name == "floor") {
        body.type = model::BodyType::half_space;
        continue;
      }
      body.nodes = box.points;
      body.triangles = geometry::boundary_triangles(box);
      for (Vec3& x : body.nodes) x = name == "b" ? Vec3(3, 0, 0) + 0.02 * x : x;
      for (const Vec3& x : body.nodes) rest.insert(rest.end(), x.data(), x.data() + 3);
    }
    fields["contact_pressure"].assign(rest.size() / 3, 0);
    fields["contact_pressure"][5] = 8e3;
  }

  Params root;
  std::vector<model::BodyInput> bodies;
  std::vector<double> rest;
  std::map<std::string, std::vector<double>> fields;
};

TEST_F(SceneViewTest, CamerasTakeTheirBlocks) {
  SceneView view(root, bodies);
  EXPECT_EQ(view.cameras(), (std::vector<std::string>{"all", "map", "free", "push", "free_push", "riding"}));
  const RenderJob all = view.job("all", fields, "hello"), map = view.job("map", fields, "");
  EXPECT_EQ(all.width, 320);
  EXPECT_EQ(all.height, 200);
  EXPECT_EQ(all.caption, "hello");
  EXPECT_EQ(all.camera.model, Camera::Model::pinhole);
  EXPECT_NEAR(all.camera.fov, 0.698132, 1e-6);
  EXPECT_EQ(all.background_top, Vec3(0.2, 0.4, 0.6));
  EXPECT_EQ(all.meshes.size(), 2u);
  ASSERT_EQ(all.planes.size(), 1u);
  EXPECT_EQ(all.planes[0].normal, Vec3(0, 0, 1));
  EXPECT_FALSE(all.bar);
  EXPECT_TRUE(all.annotated);
  EXPECT_FALSE(map.annotated);
  EXPECT_EQ(map.camera.model, Camera::Model::fisheye);
  EXPECT_EQ(map.background_top, Vec3(0, 0, 0));
  EXPECT_EQ(map.meshes.size(), 1u);
  EXPECT_TRUE(map.planes.empty());
}

TEST_F(SceneViewTest, OnlySlopesAreChequered) {
  EXPECT_EQ(SceneView(root, bodies).job("all", fields, "").planes[0].checker, 0);
  bodies[2].params.set("normal", Params::make_list({Params::make_number(0.3), Params::make_number(0), Params::make_number(1)}));
  EXPECT_GT(SceneView(root, bodies).job("all", fields, "").planes[0].checker, 0.1);
}

TEST_F(SceneViewTest, ColourBarsSpeakTheirUnit) {
  SceneView view(root, bodies);
  const RenderJob map = view.job("map", fields, "");
  ASSERT_TRUE(map.bar);
  EXPECT_EQ(map.bar->label, "contact pressure");
  EXPECT_EQ(map.bar->unit, "kPa");
  EXPECT_DOUBLE_EQ(map.bar->scale, 1e-3);
  EXPECT_DOUBLE_EQ(map.bar->high, 20e3);
  EXPECT_DOUBLE_EQ(*std::max_element(map.meshes[0].scalar.begin(), map.meshes[0].scalar.end()), 8e3);
  EXPECT_FALSE(view.job("map", {}, "").bar);  // no such field in this frame
  EXPECT_EQ(view.job("free", fields, "").bar->unit, "Pa") << "a number without one says nothing";
  EXPECT_EQ(view.job("free", fields, "").bar->scale, 1);
}

TEST_F(SceneViewTest, AColourScaleWithoutRangeOnlyGrows) {
  SceneView view(root, bodies);
  EXPECT_DOUBLE_EQ(view.job("free", fields, "").bar->high, 8e3);
  fields["contact_pressure"][5] = 1e3;
  EXPECT_DOUBLE_EQ(view.job("free", fields, "").bar->high, 8e3);
  fields["contact_pressure"][5] = 9e3;
  EXPECT_DOUBLE_EQ(view.job("free", fields, "").bar->high, 9e3);
  view.forget_scales();
  fields["contact_pressure"][5] = 1e3;
  EXPECT_LT(view.job("free", fields, "").bar->high, 9e3);
}

// A uniform pull at the top of the cube: traction is force over area, and its arrows add up to it.
TEST_F(SceneViewTest, ArrowsOfTraction) {
  SceneView view(root, bodies);
  const model::BodyInput& a = bodies[0];
  std::vector<double>& contact = fields["contact_force"];
  std::vector<double>& friction = fields["friction_force"];
  contact.assign(rest.size(), 0), friction.assign(rest.size(), 0);
  std::vector<double> area(a.nodes.size(), 0);
  for (const Triangle& t : a.triangles)
    for (const Index v : t.v) area[v] += (a.nodes[t.v[1]] - a.nodes[t.v[0]]).cross(a.nodes[t.v[2]] - a.nodes[t.v[0]]).norm() / 6;
  for (std::size_t i = 0; i < a.nodes.size(); ++i)
    if (a.nodes[i].z() > 0.49) contact[3 * i + 2] = 4e3 * area[i], friction[3 * i] = 3e3 * area[i];
  const RenderJob push = view.job("push", fields, "t = 1 s");
  EXPECT_EQ(push.arrows.size(), 9u) << "the nodes of the top";
  for (const Arrow& arrow : push.arrows) EXPECT_LT((arrow.to - arrow.from - Vec3(0.15, 0, 0.2)).norm(), 1e-12);
  EXPECT_EQ(push.caption, "t = 1 s     longest arrow 10 kPa");
  const RenderJob free_push = view.job("free_push", fields, "");
  const double height = 2 * (Vec3(1, 0, 0) - Vec3(0, -9, 2)).norm() * std::tan(20 * M_PI / 180);
  for (const Arrow& arrow : free_push.arrows) EXPECT_NEAR(arrow.to.z() - arrow.from.z(), height / 8, 1e-9);
  EXPECT_EQ(free_push.caption, "longest arrow 4 kPa");
  for (double& f : contact) f *= 0.5;
  EXPECT_EQ(view.job("free_push", fields, "").caption, "longest arrow 4 kPa") << "a scale only grows";
  EXPECT_TRUE(view.job("all", fields, "").arrows.empty());
}

TEST_F(SceneViewTest, VectorsColourByTheirLength) {
  SceneView view(root, bodies);
  fields["contact_pressure"].assign(rest.size(), 0);
  for (int c = 0; c < 3; ++c) fields["contact_pressure"][15 + c] = 2e3 * (c == 0 ? 1 : 2) / 3;
  EXPECT_NEAR(view.job("free", fields, "").bar->high, 2e3, 1e-9);
}

TEST_F(SceneViewTest, MeshesMoveWithTheirBodies) {
  SceneView view(root, bodies);
  const auto centre = [](const DrawMesh& m) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : m.points) box.extend(p);
    return Vec3(box.center());
  };
  view.move(rest);
  const RenderJob before = view.job("all", fields, "");
  const Vec3 a = centre(*before.meshes[0].mesh), b = centre(*before.meshes[1].mesh);
  EXPECT_NEAR(b.x(), 3, 0.002);
  for (std::size_t i = 0; i < 3 * bodies[0].nodes.size(); i += 3) rest[i] += 1;
  for (std::size_t i = 3 * bodies[0].nodes.size(); i < rest.size(); i += 3) rest[i + 2] += 2;
  view.move(rest);
  EXPECT_LT((centre(*before.meshes[0].mesh) - a - Vec3(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((centre(*before.meshes[1].mesh) - b - Vec3(0, 0, 2)).norm(), 1e-12);
  EXPECT_THROW(view.move(std::vector<double>(3)), Error);
}

// Half a turn and a way: what is before the camera stays before it.
TEST_F(SceneViewTest, CamerasRideOnBodies) {
  SceneView view(root, bodies);
  view.move(rest);
  EXPECT_LT((view.job("riding", fields, "").camera.position - Vec3(3, 0, 2)).norm(), 1e-12);
  for (std::size_t i = 3 * bodies[0].nodes.size(); i < rest.size(); i += 3) {
    const Vec3 x(rest[i], rest[i + 1], rest[i + 2]), y = Vec3(5, 6, 7) + Vec3(-x[2], -x[1], -x[0]);
    std::copy(y.data(), y.data() + 3, rest.begin() + static_cast<std::ptrdiff_t>(i));
  }
  view.move(rest);
  const Camera c = view.job("riding", fields, "").camera;
  EXPECT_LT((c.position - Vec3(3, 6, 4)).norm(), 1e-12);
  EXPECT_LT((c.look_at - Vec3(5, 6, 4)).norm(), 1e-12);
  EXPECT_LT((c.up - Vec3(0, -1, 0)).norm(), 1e-12);
  EXPECT_EQ(view.job("all", fields, "").camera.position, Vec3(0, -9, 2)) << "others stand";
}

TEST_F(SceneViewTest, MaterialsComeFromTheMeshOrTheScene) {
  SceneView view(root, bodies);
  const RenderJob job = view.job("all", fields, "");
  EXPECT_EQ(job.meshes[0].mesh->materials[0].colour, Vec3(1, 0, 0));
  EXPECT_DOUBLE_EQ(job.meshes[0].mesh->materials[0].roughness, 0.2);
  const Material& shell = job.meshes[1].mesh->materials[0];
  ASSERT_TRUE(shell.texture);
  EXPECT_EQ(shell.texture->width, 1024);
  EXPECT_NEAR(shell.roughness, 0.42, 1e-9);
}

}  // namespace
}  // namespace mortise::render
