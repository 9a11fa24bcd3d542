#pragma once
// A scene of two frames with all that an export may meet: a stiff body that moves and turns, a soft one that stretches, one that stands still, a
// plane.
#include "exporters/frames.h"
#include "geometry/primitives.h"
#include "geometry/topology.h"
#include "place.h"
#include "render/from_scene.h"
#include "scene/scene.h"

namespace mortise::exporters::test {

struct Sample {
  Sample() {
    const std::string assets = test_place::kSourceFolder + "/scenes/tactile/assets";
    const std::string text = R"(
mortise: 1
name: sample
time: {mode: static, steps: 1}
materials: {gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000}}
bodies:
  urchin: {type: stiff, mass: 1, shape: {box: {size: [2, 1, 1], edge_length: 1}}, visual: {mesh: )" +
                             assets + R"(/urchin.obj, scale: 0.02}}
  pad: {type: soft, material: gel, shape: {box: {size: [1, 1, 1], edge_length: 0.5}}, visual: {color: [1, 0, 0], roughness: 0.25, metallic: 1}}
  post: {type: stiff, mass: 1, shape: {box: {size: [2, 1, 1], edge_length: 1}}}
  floor: {type: half_space, point: [0, 0, -1], visual: {color: [0, 0, 1]}}
effects: {elasticity: {}, affine_body: {}}
render:
  width: 320
  height: 160
  cameras:
    fixed: {position: [0, -9, 2], look_at: [1, 0, 0], fov: 0.5}
    riding: {position: [0, 0, 5], look_at: [0, 0, 0], up: [0, 1, 0], rides_on: urchin}
    eye: {position: [0, -9, 2], look_at: [1, 0, 0], model: fisheye, fov: 3}
)";
    static const ParamTable none{"effect elasticity", "", {}};
    const std::vector<scene::EffectTable> effects{{"elasticity", "", &none}, {"affine_body", "", &none}};
    root = scene::read_scene_text(text, "sample.yaml", {}, effects).root;
    const geometry::TetMesh cube = geometry::box(Vec3(1, 1, 1), 0.5), block = geometry::box(Vec3(2, 1, 1), 1.0);
    for (const auto& [name, params] : root.at("bodies").entries()) {
      model::BodyInput& body = bodies.emplace_back();
      body.name = name, body.params = params;
      body.type = name == "floor" ? model::BodyType::half_space : name == "pad" ? model::BodyType::soft : model::BodyType::stiff;
      if (name == "floor") continue;
      const geometry::TetMesh& mesh = name == "pad" ? cube : block;
      body.nodes = mesh.points;
      body.triangles = geometry::boundary_triangles(mesh);
      for (Vec3& x : body.nodes) x += name == "pad" ? Vec3(5, 0, 0) : name == "post" ? Vec3(0, 5, 0) : Vec3(0, 0, 0);
    }
    for (int frame = 0; frame < 3; ++frame) {
      std::vector<double>& all = points.emplace_back();
      for (const model::BodyInput& body : bodies)
        for (const Vec3& x : body.nodes) {
          const Vec3 y = body.name == "urchin" ? Vec3(turn(frame) * x + way(frame))
                         : body.name == "pad"  ? Vec3(x[0], x[1], (1 + 0.25 * frame) * x[2])
                                               : x;
          all.insert(all.end(), y.data(), y.data() + 3);
        }
      frames.numbers.push_back(10 * frame), frames.times.push_back(0.2 + 0.1 * frame);
    }
    frames.points = [this](std::size_t k) { return points[k]; };
  }

  // Of the urchin: a quarter turn about z and a way per frame.
  static Mat3 turn(int frame) { return Eigen::AngleAxisd(0.5 * M_PI * frame, Vec3::UnitZ()).toRotationMatrix(); }
  static Vec3 way(int frame) { return frame * Vec3(0, 0, 3); }

  Params root;
  std::vector<model::BodyInput> bodies;
  std::vector<std::vector<double>> points;
  Frames frames;
};

}  // namespace mortise::exporters::test
