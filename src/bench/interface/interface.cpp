// B03, B04: two blocks under the pressure p from all sides. sigma = -p I in every tetrahedron, whatever surface they meet in: exactly when
// it is a plane, with an error that falls with the mesh when it is curved, because the facets of the two meshes differ.
#include <fmt/format.h>

#include <numbers>

#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/traction.h"

namespace mortise::bench {
namespace {

constexpr double kHeight = 2;  // of both blocks together; their base is 1 x 1 [m]

// z = f(x, y) between the blocks, and what the upper block keeps away from it along the normal.
struct Interface {
  double slope = 0;      // inclined along x
  double amplitude = 0;  // of waves whose crests meet the sides of the blocks at right angles [m]
  double z(double x, double y) const { return 0.5 * kHeight + slope * (x - 0.5) + amplitude * std::cos(kWave * x) * std::cos(kWave * y); }
  Vec3 normal(double x, double y) const {
    const double fx = slope - amplitude * kWave * std::sin(kWave * x) * std::cos(kWave * y),
                 fy = -amplitude * kWave * std::cos(kWave * x) * std::sin(kWave * y);
    return Vec3(-fx, -fy, 1).normalized();
  }
  static constexpr double kWave = std::numbers::pi;
};

// The unit cube's third coordinate runs from the base to the interface.
void shape_bottom(geometry::TetMesh& cube, const Interface& f) {
  for (Vec3& x : cube.points) x[2] *= f.z(x[0], x[1]);
}

// ... from the interface, moved by the gap along its normals, to the top. An inclined block moves as a whole.
void shape_top(geometry::TetMesh& cube, const Interface& f, double gap) {
  for (Vec3& x : cube.points) {
    const double s = x[2];
    const Vec3 apart = gap * f.normal(x[0], x[1]);
    x[2] = (1 - s) * f.z(x[0], x[1]) + s * kHeight;
    x += f.amplitude > 0 ? (1 - s) * apart : apart;
  }
}

Solved run(const Bench& b, const Method& m, const Interface& f, double p, double d_hat, double kappa, const std::array<int, 3>& below,
           const std::array<int, 3>& above, double jitter) {
  const double E = b.scene().number("materials.rubber.youngs_modulus");
  const double shrink = 1 - p * (1 - 2 * b.scene().number("materials.rubber.poisson_ratio")) / E;
  // Loads count areas at rest, contact those of now. Everything shrinks about the origin, the gap with it.
  const double gap = d_hat * barrier_gap(p / (kappa * shrink * shrink)) / shrink;
  SceneText scene = b.scene();
  for (int i = 0; i < 5; ++i) scene.set(fmt::format("effects.pressure_load.{}.pressure", i), p);
  scene.set("effects.mortar_contact.d_hat", d_hat);
  scene.set("effects.mortar_contact.stiffness", kappa);
  if (f.amplitude == 0) {
    const double aside = -gap * f.normal(0, 0)[0];  // of the upper block
    scene.set(scene.pin("top", "x") + ".motion", fmt::format("{{time: [0, 1], translation: [[0, 0, 0], [{:.17g}, 0, 0]]}}", (1 - shrink) * aside));
  }
  if (m.effect != "mortar_contact") scene.set("solver", "{relative_tolerance: 1e-9}");  // they do not settle to rounding
  scene.use(m, 1.0 / (below[0] * below[1]));
  return solve(scene, [&](model::ModelInput& input) {
    geometry::TetMesh bottom = jittered_block(Vec3::Zero(), Vec3::Ones(), below, jitter, 1),
                      top = jittered_block(Vec3::Zero(), Vec3::Ones(), above, jitter, 2);
    shape_bottom(bottom, f), shape_top(top, f, gap);
    set_mesh(input, "bottom", bottom), set_mesh(input, "top", top);
  });
}

struct Deviation {
  double largest = NAN, mean = NAN;  // of the stress from -p I over p; mean: L2 over the volume
};
Deviation deviation(const Solved& s, double p) {
  const auto field = s.fields.cell.find("cauchy_stress");
  if (field == s.fields.cell.end()) return {};
  const std::vector<double>& v = field->second;
  Deviation out{0, 0};
  double volume = 0;
  std::size_t t = 0;
  for (const model::BodyInput& body : s.input.bodies)
    for (const Tet& tet : body.tets) {
      const auto edge = [&](int k) { return Vec3(body.nodes[tet.v[k]] - body.nodes[tet.v[0]]); };
      const double V = edge(1).cross(edge(2)).dot(edge(3)) / 6;
      double square = 0;
      for (int c = 0; c < 6; ++c) {
        const double e = v[6 * t + c] / p + (c < 3 ? 1 : 0);
        out.largest = std::max(out.largest, std::abs(e));
        square += (c < 3 ? 1 : 2) * e * e;
      }
      out.mean += V * square / 3, volume += V;
      ++t;
    }
  out.mean = std::sqrt(out.mean / volume);
  return out;
}

void tilted(const Bench& b, double p) {
  for (double angle : {5.0, 15.0, 30.0, 45.0})
    for (const Method& m : b.methods()) {
      Interface f;
      f.slope = std::tan(angle * std::numbers::pi / 180);
      const Solved s = run(b, m, f, p, b.scene().number("effects.mortar_contact.d_hat"), b.scene().number("effects.mortar_contact.stiffness"),
                           {3, 3, 2}, {2, 2, 2}, 0.25);
      const double e = deviation(s, p).largest;
      b.emit(s.row(fmt::format("tilt={:g}", angle), m, "stress (worst)", -p * (1 + e), -p, e, m.gated ? 1e-10 : NAN));
    }
}

void curved(const Bench& b, double p) {
  // Facets of different meshes are about 0.06 h^2 apart, and every gap counts with 5 p/d_hat at least: a soft layer, thick against h^2. Where
  // it is thick against the radius of curvature as well, its two sides differ and the facets' normals leave the blocks at the rim.
  constexpr double kLayer = 0.02;  // d_hat [m]
  const int finest = b.count("finest", 16);
  Interface f;
  f.amplitude = 0.05;
  for (const Method& m : b.methods()) {
    double before = NAN, rate = NAN;
    Solved s;
    for (int n = finest / 4; n <= finest; n *= 2) {
      s = run(b, m, f, p, kLayer, p, {n, n, n}, {3 * n / 4, 3 * n / 4, 3 * n / 4}, 0);
      const Deviation d = deviation(s, p);
      b.emit(s.row(fmt::format("waves, h=1/{}", n), m, "stress L2", d.mean, 0, d.mean, NAN));
      const Traction t = nodal_traction(s, "bottom", [&](const Vec3& x) { return std::abs(x[2] - f.z(x[0], x[1])) < 1e-9; });
      const auto l2_where = [&](const std::function<bool(const Vec3&)>& in) { return t.l2([&](const Vec3&) { return p; }, in); };
      const double l2 = l2_where([](const Vec3&) { return true; }), rim = 0.5 / n;
      const double inside = l2_where([&](const Vec3& x) { return std::min(x[0], x[1]) > rim && std::max(x[0], x[1]) < 1 - rim; });
      b.emit(s.row(fmt::format("waves, h=1/{}", n), m, "pressure L2", l2, 0, l2, NAN));
      b.emit(s.row(fmt::format("waves, h=1/{}", n), m, "pressure L2, inside", inside, 0, inside, NAN));
      rate = std::log2(before / l2), before = l2;
    }
    b.emit(s.row("waves", m, "rate of pressure L2", rate, 2, std::max(0.0, 2 - rate), m.gated ? 0.2 : NAN));  // at least 1.8
  }
}

}  // namespace

void interface(const Bench& b) {
  const double p = b.scene().number("effects.pressure_load.0.pressure");
  tilted(b, p);
  curved(b, 0.1 * p);  // strains so small that only the meshes make errors
}

}  // namespace mortise::bench
