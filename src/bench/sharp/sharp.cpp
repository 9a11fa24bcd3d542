// Sharp features: a rigid box is pressed into a pad edge first, corner first or nearly flat. Samples on faces alone let edges through
//; what counts is the true gap of the box's edges above the pad's triangles.
#include <fmt/format.h>

#include <numbers>

#include "bench/all.h"
#include "bench/meshes.h"

namespace mortise::bench {
namespace {

struct Case {
  const char* name;
  double roll, pitch;  // of the box about the y axis, then about the x axis [deg]
};
constexpr Case kCases[] = {{"edge, 45 deg", 45, 0}, {"edge, 10 deg", 10, 0}, {"corner, 30 and 35 deg", 30, 35}};

// Of d_hat. The guard and collision detection alone also keep surfaces apart, but nearer; edge samples alone keep 0.44 and more.
constexpr double kLeastGap = 0.3;

// Smallest distance along the pad's normals of points on the box's edges above the pad's upper face; below it is negative.
double edge_gap(const Solved& s) {
  constexpr int kPoints = 2000;  // per edge
  std::vector<Vec3> pad, box;
  std::vector<Triangle> top;
  std::vector<std::pair<Index, Index>> edges;
  std::size_t first = 0;
  for (const model::BodyInput& body : s.input.bodies) {
    auto& at = body.name == "pad" ? pad : box;
    for (std::size_t i = first; i < first + body.nodes.size(); ++i) at.push_back(Vec3(s.points[3 * i], s.points[3 * i + 1], s.points[3 * i + 2]));
    first += body.nodes.size();
    for (const Triangle& t : body.triangles) {
      if (body.name == "pad" && std::abs(body.nodes[t.v[0]][2]) + std::abs(body.nodes[t.v[1]][2]) + std::abs(body.nodes[t.v[2]][2]) < 1e-9)
        top.push_back(t);
      if (body.name == "box")
        for (int k = 0; k < 3; ++k)
          if (t.v[k] < t.v[(k + 1) % 3]) edges.emplace_back(t.v[k], t.v[(k + 1) % 3]);
    }
  }
  double smallest = INFINITY;
  for (const auto& [i, j] : edges)
    for (int k = 0; k <= kPoints; ++k) {
      const Vec3 x = box[i] + (box[j] - box[i]) * k / kPoints;
      for (const Triangle& t : top) {
        const Vec3 a = pad[t.v[0]], u = pad[t.v[1]] - a, v = pad[t.v[2]] - a, d = x - a, n = u.cross(v).normalized();
        if (d.dot(n) > smallest) continue;
        const double det = u[0] * v[1] - u[1] * v[0], s1 = (d[0] * v[1] - d[1] * v[0]) / det, s2 = (u[0] * d[1] - u[1] * d[0]) / det;
        if (s1 >= 0 && s2 >= 0 && s1 + s2 <= 1) smallest = d.dot(n);
      }
    }
  return smallest;
}

}  // namespace

void sharp(const Bench& b) {
  const double d_hat = b.scene().number("effects.mortar_contact.d_hat"), gap = 0.5 * d_hat;
  for (const Case& c : kCases)
    for (const Method& m : b.methods()) {
      SceneText scene = b.scene();
      // From half of d_hat above the pad to where the lowest edge or corner would be 2 d_hat deep.
      scene.set(scene.moving_pin() + ".motion.translation.1", fmt::format("[0, 0, {:.17g}]", -gap - 2 * d_hat));
      scene.use(m, 0.01);
      const double steps = scene.number("time.steps");
      Solved s;
      double smallest = INFINITY, largest = 0;
      long done = 0;
      s = solve(
          scene,
          [&](model::ModelInput& input) {
            set_mesh(input, "pad", jittered_block(Vec3(0, 0, -0.5), Vec3(1, 1, 0), {6, 6, 3}, 0.2, 3));
            geometry::TetMesh box = jittered_block(Vec3(-0.275, -0.3, -0.25), Vec3(0.275, 0.3, 0.25), {1, 1, 1}, 0, 1);
            const double degree = std::numbers::pi / 180;
            const Mat3 R =
                (Eigen::AngleAxisd(c.pitch * degree, Vec3::UnitX()) * Eigen::AngleAxisd(c.roll * degree, Vec3::UnitY())).toRotationMatrix();
            double lowest = INFINITY;
            for (Vec3& x : box.points) x = R * x, lowest = std::min(lowest, x[2]);
            for (Vec3& x : box.points) x += Vec3(0.48, 0.53, gap - lowest);
            set_mesh(input, "box", box);
          },
          [&](const Snapshot& f) {
            ++done;
            largest = std::max(largest, std::abs(f.at(m.effect + "/force_box_z")));
          });
      smallest = edge_gap(s);
      b.emit(s.row(c.name, m, "steps that converged", static_cast<double>(done), steps, steps - static_cast<double>(done), m.gated ? 0 : NAN));
      const double t = smallest / d_hat;
      b.emit(s.row(c.name, m, "gap of edges over d_hat", t, kLeastGap, std::max(0.0, kLeastGap - t), m.gated ? 0 : NAN));
      b.emit(s.row(c.name, m, "force [N]", largest, NAN, NAN, NAN));
    }
}

}  // namespace mortise::bench
