#include "bench/hertz/pressure_map.h"

#include <cmath>
#include <numbers>

#include "render/renderer.h"

namespace mortise::bench {
namespace {

constexpr double kShown = 1.6;  // radii

struct Face {
  render::DrawMesh mesh;
  std::vector<double> pressure;
};

// One of the four mirror images of the face; signs -1 or 1.
Face face(const PressureMap& map, const Solved& s, const Traction& t, double sx, double sy) {
  Face out;
  const model::BodyInput* body = nullptr;
  for (const model::BodyInput& b : s.input.bodies)
    if (b.name == map.body) body = &b;
  std::vector<Index> place(body->nodes.size(), -1);
  for (std::size_t i = 0; i < t.node.size(); ++i) {
    place[t.node[i]] = static_cast<Index>(i);
    out.mesh.points.push_back({sx * t.now[i][0], sy * t.now[i][1], t.now[i][2]});
    out.pressure.push_back(std::max(0.0, t.p[i]));
  }
  out.mesh.normals.assign(out.mesh.points.size(), Vec3::Zero());
  for (const Triangle& triangle : body->triangles) {
    Triangle at;
    bool shown = true;
    for (int k = 0; k < 3; ++k) {
      at.v[k] = place[triangle.v[k]];
      shown = shown && at.v[k] >= 0 && out.mesh.points[at.v[k]].head<2>().norm() < 5 * kShown * map.radius;
    }
    if (!shown) continue;
    if (sx * sy < 0) std::swap(at.v[1], at.v[2]);
    const Vec3 &a = out.mesh.points[at.v[0]], &b = out.mesh.points[at.v[1]], &c = out.mesh.points[at.v[2]];
    for (Index v : at.v) out.mesh.normals[v] += (b - a).cross(c - a);
    out.mesh.triangles.push_back(at);
  }
  for (Vec3& n : out.mesh.normals) n = n.norm() > 0 ? n.normalized() : Vec3(Vec3::UnitZ());
  return out;
}

// A thin ring of this radius just above the height z.
render::DrawMesh circle(double radius, double z) {
  render::DrawMesh mesh;
  constexpr int kParts = 180;
  for (int k = 0; k < kParts; ++k) {
    const double angle = 2 * std::numbers::pi * k / kParts;
    for (double r : {0.994 * radius, 1.006 * radius}) mesh.points.push_back({r * std::cos(angle), r * std::sin(angle), z});
    const Index a = 2 * k, b = 2 * ((k + 1) % kParts);
    mesh.triangles.push_back({a, a + 1, b}), mesh.triangles.push_back({b, a + 1, b + 1});
  }
  mesh.normals.assign(mesh.points.size(), Vec3::UnitZ());
  mesh.materials[0].colour = Vec3(1, 1, 1);
  return mesh;
}

}  // namespace

void write_pressure_map(const std::string& path, const PressureMap& map, const Solved& s, const Traction& t) {
  std::vector<Face> faces;
  for (double sx : {1.0, -1.0})
    for (double sy : {1.0, -1.0}) faces.push_back(face(map, s, t, sx, sy));
  double top = -INFINITY;  // the surface where the circle runs
  for (std::size_t i = 0; i < t.now.size(); ++i)
    if (t.now[i].head<2>().norm() < kShown * map.radius) top = std::max(top, t.now[i][2]);
  const render::DrawMesh ring = circle(map.radius, top + 0.01 * map.radius);
  render::RenderJob job;
  job.width = 960, job.height = 720;
  for (const Face& f : faces) job.meshes.push_back({&f.mesh, f.pressure});
  job.meshes.push_back({&ring, {}});
  job.camera.position = Vec3(0, 0, top + 9.8 * map.radius);
  job.camera.look_at = Vec3(0, 0, top);
  job.camera.up = Vec3::UnitY();
  job.camera.fov = 2 * std::atan(kShown / 9.8);
  job.bar = render::ColourBar{"contact pressure", "kPa", 0, map.highest, 1e-3};
  job.caption = map.caption;
  render::write_png(path, render::Renderer().draw(job));
}

}  // namespace mortise::bench
