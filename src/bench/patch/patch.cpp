// B01, B02, B05: two blocks under uniform pressure p. sigma_zz = -p and nothing else, in every tetrahedron, whatever the meshes,
// the contact parameters, the side that is integrated over and the direction of the stack; and the nodal contact pressure is the same everywhere.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "audit/contact_patch.h"
#include "base/error.h"
#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "geometry/midsides.h"

namespace mortise::bench {
namespace {

constexpr double kHeight = 0.5;  // of each block [m]

struct Case {
  std::string name = "non-matching";
  double d_hat = 1e-2, kappa = 1e6, nu = 0.3;
  double angle = 0;  // of the stack about the y axis [deg]
  std::string slave = "bottom", quadrature = "3", gradient = "frozen";
  bool two_pass = false, matching = false;
  double bottom_side = 1, top_side = 1;  // squares that share the corner at the origin [m]
  bool all_methods = false;
  int finer = 1;       // cells per cell
  bool isaac = false;  // 56/125 under 32/70 vertices/tetrahedra, as in the report on IsaacIPC
  int order = 1;       // of the tetrahedra
};

std::string triple(const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v[0], v[1], v[2]); }

// Selects the nodes of an edge along y, or of the plane through `at` with normal n: a ball so large that it is flat here.
std::string edge(const Vec3& at) {
  return fmt::format("{{box: {{min: {}, max: {}}}}}", triple(at - Vec3(1e-6, 1, 1e-6)), triple(at + Vec3(1e-6, 2, 1e-6)));
}
std::string plane(const Vec3& at, const Vec3& n) {
  constexpr double kRadius = 1e6;
  return fmt::format("{{sphere: {{centre: {}, radius: {:.17g}}}}}", triple(at + kRadius * n), kRadius + 1e-5);
}

// What the larger square has bare of the smaller one: pressure p on two rectangles at height z.
std::string bare(const std::string& body, double small, double large, double z, double p) {
  const auto part = [&](double x0, double x1, double y0, double y1) {
    return fmt::format(", {{body: {}, where: {{box: {{min: {}, max: {}}}}}, pressure: {:.17g}}}", body, triple(Vec3(x0 - 1e-6, y0 - 1e-6, z - 1e-6)),
                       triple(Vec3(x1 + 1e-6, y1 + 1e-6, z + 1e-6)), p);
  };
  return part(small, large, 0, large) + part(0, small, small, large);
}

struct Stress {
  double zz = NAN, spurious = NAN;  // largest deviations over p
};

// In the turned stack's own axes.
Stress stress_error(const Solved& s, const Mat3& R, double p) {
  Stress out{0, 0};
  const auto field = s.fields.cell.find("cauchy_stress");
  if (field == s.fields.cell.end()) return {};
  const auto judge = [&](const std::vector<double>& v) {
    for (std::size_t i = 0; i + 5 < v.size(); i += 6) {
      Mat3 S;
      S << v[i], v[i + 3], v[i + 5], v[i + 3], v[i + 1], v[i + 4], v[i + 5], v[i + 4], v[i + 2];
      Mat3 e = R.transpose() * S * R / p;
      e(2, 2) += 1;
      out.zz = std::max(out.zz, std::abs(e(2, 2)));
      e(2, 2) = 0;
      out.spurious = std::max(out.spurious, e.cwiseAbs().maxCoeff());
    }
  };
  judge(field->second);
  // Of quadratic tetrahedra that was the mean; every point of integration counts.
  if (const auto points = s.fields.row.find("elasticity/point_stress"); points != s.fields.row.end()) judge(points->second);
  return out;
}

// How far nodal contact pressures inside of the patch are from their mean, root mean square over that.
double pressure_error(const Solved& s) {
  const Snapshot::Values* p = s.fields.of_points("contact_pressure", 1);
  if (!p) return NAN;
  double sum = 0, square = 0;
  const std::vector<audit::ContactPatch::Node> interior = audit::ContactPatch(s.input).interior({*p, *s.fields.of_points("contact_force", 3), {}});
  for (const auto& node : interior) sum += (*p)[node.point];
  const double n = static_cast<double>(interior.size()), mean = sum / n;
  for (const auto& node : interior) square += ((*p)[node.point] - mean) * ((*p)[node.point] - mean);
  return std::sqrt(square / n) / mean;
}

Solved solved(const Bench& b, const Case& c, const Method& m) {
  const double p = b.scene().number("effects.pressure_load.0.pressure"), E = b.scene().number("materials.rubber.youngs_modulus");
  const double gap = 0.5 * c.d_hat, lift = kHeight + gap, radians = c.angle * std::numbers::pi / 180;
  const Mat3 R = Eigen::AngleAxisd(radians, Vec3::UnitY()).toRotationMatrix();
  const Vec3 up = R * Vec3::UnitZ();

  SceneText scene = b.scene();
  scene.set("materials.rubber.poisson_ratio", c.nu);
  scene.set("effects.mortar_contact.pairs", fmt::format("[{{slave: {}, master: {}}}]", c.slave, c.slave == "top" ? "bottom" : "top"));
  scene.set("effects.mortar_contact.d_hat", c.d_hat);
  scene.set("effects.mortar_contact.stiffness", c.kappa);
  scene.set("effects.mortar_contact.quadrature", "\"" + c.quadrature + "\"");
  scene.set("effects.mortar_contact.gradient", c.gradient);
  scene.set("effects.mortar_contact.two_pass", c.two_pass ? "true" : "false");

  // Bottom: the edges (0, y, 0) and (s, y, 0) follow the exact solution. Top: one edge is held along x; that fixes how it slides and carries
  // nothing, since neither the load nor frictionless contact has a part along the interface. The exact sliding is zero: the edge sinks
  // along the axis of the stack by the shortening of the bottom and what the gap changes. Pressure acts on the current area (1 + nu p/E)^2.
  const double e = c.nu * p / E, closed = c.d_hat * barrier_gap(p / c.kappa / ((1 + e) * (1 + e)));
  const Vec3 stretch = R * Vec3(c.bottom_side * e, 0, 0), sink = (-p * kHeight / E + closed - gap) * up;
  scene.set("effects.pin",
            fmt::format("[{{body: bottom, where: {{side: y_min}}, axes: y}}, {{body: top, where: {{side: y_min}}, axes: y}}, {{body: bottom, where: "
                        "{}, axes: xz}}, "
                        "{{body: bottom, where: {}, axes: xz, motion: {{time: [0, 1], translation: [[0, 0, 0], {}]}}}}, "
                        "{{body: top, where: {}, axes: x, motion: {{time: [0, 1], translation: [[0, 0, 0], {}]}}}}]",
                        edge(Vec3(0, 0, 0)), edge(R * Vec3(c.bottom_side, 0, 0)), triple(stretch), edge(R * Vec3(0, 0, lift)), triple(sink)));
  std::string loads = fmt::format("[{{body: bottom, where: {}, pressure: {:.17g}}}, {{body: top, where: {}, pressure: {:.17g}}}",
                                  plane(Vec3(0, 0, 0), -up), p, plane((lift + kHeight) * up, up), p);
  if (c.top_side < c.bottom_side) loads += bare("bottom", c.top_side, c.bottom_side, kHeight, p);
  if (c.top_side > c.bottom_side) loads += bare("top", c.bottom_side, c.top_side, lift, p);
  scene.set("effects.pressure_load", loads + "]");

  // Overhanging blocks have regular meshes, so that the bare part consists of whole triangles.
  const bool overhang = c.top_side != c.bottom_side;
  const int f = c.finer;
  const std::array<int, 3> coarse{2 * f, 2 * f, 2 * f}, fine{3 * f, 3 * f, 2 * f}, regular{4 * f, 4 * f, 2 * f};
  const bool top_larger = c.top_side > c.bottom_side;
  const std::array<int, 3> under = !overhang ? fine : top_larger ? coarse : regular;
  const std::array<int, 3> above = c.matching ? under : top_larger ? regular : coarse;
  const double jitter = overhang ? 0 : 0.25;
  scene.use(m, c.bottom_side * c.bottom_side / (under[0] * under[1]));
  return solve(scene, [&](model::ModelInput& input) {
    const auto place = [&](const std::string& body, double side, double z, const std::array<int, 3>& cells, std::uint32_t seed, bool mirrored) {
      geometry::TetMesh mesh = jittered_block(Vec3(0, 0, 0), Vec3(side, side, kHeight), cells, jitter, seed);
      if (mirrored) mesh = upside_down(std::move(mesh), kHeight);
      if (c.isaac) mesh = body == "bottom" ? split_to(std::move(mesh), 56, 125) : split_to(std::move(mesh), 32, 70);
      for (Vec3& x : mesh.points) x = R * (x + Vec3(0, 0, z));
      set_mesh(input, body, c.order == 1 ? mesh : geometry::with_midsides(mesh));
    };
    place("bottom", c.bottom_side, 0, under, 1, false);
    // Matching: the top is the mirror image of the bottom, so that the facing nodes coincide.
    place("top", c.top_side, lift, above, c.matching ? 1 : 2, c.matching);
  });
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](std::string name, const std::function<void(Case&)>& change, bool all_methods = false) {
    Case c;
    c.name = std::move(name), c.all_methods = all_methods;
    change(c);
    all.push_back(c);
  };
  add(
      "matching", [](Case& c) { c.matching = true; }, true);
  add(
      "non-matching", [](Case&) {}, true);
  add(
      "56/125 under 32/70", [](Case& c) { c.isaac = true; }, true);
  add("slave top", [](Case& c) { c.slave = "top"; });
  add("two passes", [](Case& c) { c.two_pass = true; });
  for (const char* q : {"1", "6", "7"}) add(fmt::format("quadrature {}", q), [&](Case& c) { c.quadrature = q; });
  for (double k : {1e3, 1e4, 1e5, 1e7, 1e8, 1e9, 1e10, 1e11})
    add(
        fmt::format("kappa={:.0e}", k), [&](Case& c) { c.kappa = k; }, k == 1e4 || k == 1e8);
  for (double d : {1e-3, 1e-4, 1e-5})
    add(
        fmt::format("d_hat={:.0e}", d), [&](Case& c) { c.d_hat = d, c.kappa = 1e4 / d; }, true);
  for (double nu : {0.0, 0.45, 0.49}) add(fmt::format("nu={:g}", nu), [&](Case& c) { c.nu = nu; });
  for (double a : {10.0, 30.0, 60.0})
    add(
        fmt::format("tilt={:g}", a), [&](Case& c) { c.angle = a; }, a == 30);
  add(
      "top smaller", [](Case& c) { c.top_side = 0.75; }, true);
  add("top smaller, slave top", [](Case& c) { c.top_side = 0.75, c.slave = "top"; });
  add(
      "top overhangs", [](Case& c) { c.bottom_side = 0.75; }, true);
  add("top overhangs, slave top", [](Case& c) { c.bottom_side = 0.75, c.slave = "top"; });
  add("matching", [](Case& c) { c.order = 2, c.matching = true; });
  add(
      "non-matching", [](Case& c) { c.order = 2; }, true);
  add("slave top", [](Case& c) { c.order = 2, c.slave = "top"; });
  add("tilt=30", [](Case& c) { c.order = 2, c.angle = 30; });
  add("top smaller", [](Case& c) { c.order = 2, c.top_side = 0.75; });
  return all;
}

}  // namespace

void patch(const Bench& b) {
  const double p = b.scene().number("effects.pressure_load.0.pressure");
  const bool one_order = !b.option("order", "").empty();
  const int order = b.order(1);
  const std::string only = b.option("case", "");
  for (Case c : cases()) {
    c.finer = b.count("finer", 1);
    if (one_order && c.order == 2) continue;  // among the first again
    if (one_order) c.order = order;
    if (c.order == 2 && c.quadrature == "1") continue;  // not for quadratic faces
    if (c.order == 2) c.name += ", quadratic";
    if (!only.empty() && c.name != only) continue;
    for (const Method& m : b.methods()) {
      if (!m.gated && !c.all_methods) continue;
      const Solved s = solved(b, c, m);
      const Stress e = stress_error(s, Eigen::AngleAxisd(c.angle * std::numbers::pi / 180, Vec3::UnitY()).toRotationMatrix(), p);
      const double gate = m.gated ? (c.order == 1 ? 1e-10 : 1e-9) : NAN;
      b.emit(s.row(c.name, m, "stress along the stack", -p * (1 + e.zz), -p, e.zz, gate));
      b.emit(s.row(c.name, m, "other stresses", p * e.spurious, 0, e.spurious, gate));
      const double uneven = pressure_error(s);
      if (std::isfinite(uneven)) b.emit(s.row(c.name, m, "unevenness of pressure", uneven, 0, uneven, NAN));
    }
  }
}

}  // namespace mortise::bench
