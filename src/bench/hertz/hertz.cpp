// B07: ball of radius R on a block or on a cylinder standing under it, all elastic, of linear or quadratic tetrahedra (edges on the ball then
// follow the sphere). Load and pressure follow Hertz; a and p0 are computed from the measured force, so that the compliance of the
// finite bodies does not matter.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "base/error.h"
#include "base/json_text.h"
#include "bench/all.h"
#include "bench/hertz/pressure_map.h"
#include "bench/hertz/profiles.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/size.h"
#include "bench/traction.h"
#include "geometry/midsides.h"

namespace mortise::bench {
namespace {

constexpr Size kSizes[] = {{"tiny", {0.025, 6, 4, 5}, 3e-3, NAN},       {"coarse", {0.016, 8, 5, 7}, 2e-3, 0.06},
                           {"small", {0.011, 11, 6, 10}, 1.2e-3, 0.05}, {"medium", {0.0075, 16, 6, 14}, 7e-4, 0.035},
                           {"isaac", {0.0067, 18, 7, 14}, 6e-4, 0.035}, {"fine", {0.004, 30, 7, 14}, 5e-4, 0.022}};
// Quadratic tetrahedra: 7.5k and 20.3k nodes in all. Their layer of contact is stiffer (k = 24): with k = 4 its compliance would be all of
// the error, 0.5 (d_hat - gap)/approach in the peak. Gated is r <= 0.9 a at the second size.
constexpr Size kQuadraticSizes[] = {{"coarse", {0.02, 5, 3, 4}, 6.6e-4, NAN}, {"medium", {0.0106, 9, 4, 5}, 3.5e-4, 0.01}};
constexpr double kExpectedRadius = 0.1;  // a/R, for the choice of kappa only

double radius_of(const Vec3& x) { return x.head<2>().norm(); }

// || p - p_Hertz || / || p_Hertz || over r <= within.
double l2_error(const Traction& at, const Hertz& exact, double within) {
  return at.l2([&](const Vec3& x) { return exact.pressure(radius_of(x)); }, [&](const Vec3& x) { return radius_of(x) <= within; });
}

// Quarter of a cylinder of radius R standing below z = 0: a square of grid planes, rounded.
geometry::TetMesh cylinder_block(double R, const Spot& spot) {
  const std::vector<double> s = graded(spot.h / R, spot.fine, spot.out, 1);
  geometry::TetMesh mesh = grid_block(s, s, spot.downwards(R));
  for (Vec3& x : mesh.points) {
    const double u = x[0], v = x[1];
    x[0] = R * u * std::sqrt(1 - v * v / 2), x[1] = R * v * std::sqrt(1 - u * u / 2);
  }
  return mesh;
}

void write(const std::string& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  if (!out.flush()) throw Error(Exit::file, "cannot write '" + path + "'");
}

// The meshes as JSON, for other programs: {"block": {"points": [[x, y, z], ...], "tets": [[a, b, c, d], ...]}, "ball": ...}.
void write_meshes(const std::string& file, const model::ModelInput& input) {
  nlohmann::ordered_json j;
  for (const model::BodyInput& body : input.bodies) {
    nlohmann::ordered_json points, tets;
    for (const Vec3& x : body.nodes) points.push_back(std::array<double, 3>{x[0], x[1], x[2]});
    for (const Tet& t : body.tets) tets.push_back(std::array<Index, 4>{t.v[0], t.v[1], t.v[2], t.v[3]});
    j[body.name] = {{"points", points}, {"tets", tets}};
  }
  write(file, json_text(j));
}

// x, y [m] and pressure [Pa] of the nodes, for other programs (tools/pressure_map.py); the exact contact radius and peak stand first.
void write_nodes(const std::string& path, const Traction& t, const Hertz& exact) {
  std::string csv = fmt::format("# contact_radius={:.9g} peak_pressure={:.9g}\nx,y,pressure\n", exact.a, exact.p0);
  for (std::size_t i = 0; i < t.p.size(); ++i) csv += fmt::format("{:.9g},{:.9g},{:.9g}\n", t.at[i][0], t.at[i][1], t.p[i]);
  write(path, csv);
}

// Profiles of all methods and sizes.
struct Figure {
  std::vector<Panel> panels;  // one per method
  void add(const std::string& method, const std::string& size, const Traction& at, const Hertz& exact) {
    auto panel = std::find_if(panels.begin(), panels.end(), [&](const Panel& p) { return p.title == method; });
    if (panel == panels.end()) panels.push_back({method, {}}), panel = panels.end() - 1;
    Dots dots{size, {}};
    for (std::size_t i = 0; i < at.p.size(); ++i)
      if (const double r = radius_of(at.at[i]); r < 1.6 * exact.a) dots.points.emplace_back(r / exact.a, at.p[i] / exact.p0);
    panel->series.push_back(std::move(dots));
  }
};

void run(const Bench& b, const Size& size, bool quadratic, Figure& figure) {
  const std::string under = b.option("under", "block");
  if (under != "block" && under != "cylinder") throw Error(Exit::usage, "--set under: block or cylinder");
  const bool cylinder = under == "cylinder";
  const double R = 1, E = b.scene().number("materials.rubber.youngs_modulus"), nu = b.scene().number("materials.rubber.poisson_ratio");
  const double e_star = E / (2 * (1 - nu * nu));
  // `layer`: a thinner one with the same start and travel, so that forces at the travel can be compared.
  // auto: the layer that a scene gets which names none.
  const bool chosen = b.option("layer", "1") == "auto";
  const double usual = b.number("d_hat", size.d_hat), d_hat = chosen ? usual : b.number("layer", 1) * usual;
  const double expected = 2 * e_star * kExpectedRadius / (3.14159265358979 * R);
  const double kappa = matched_stiffness(expected, d_hat, size.mesh.h, e_star, b.number("k", quadratic ? 24 : 4));
  // Where the ball starts decides how hard the first Newton iterations are; where it ends does not depend on it.
  const double gap = b.number("start", 0.3) * usual, end = b.scene().number(b.scene().moving_pin() + ".motion.translation.1.2") + 0.1 * usual;
  for (const Method& m : b.methods()) {
    SceneText scene = b.scene();
    scene.set("bodies.ball.position", fmt::format("[0, 0, {:.17g}]", R + gap));
    scene.set(scene.moving_pin() + ".motion.translation.1.2", end - gap);
    const auto of_layer = [chosen](double value) { return chosen ? "auto" : fmt::format("{:.17g}", value); };
    scene.set("effects.mortar_contact.d_hat", of_layer(d_hat));
    scene.set("effects.mortar_contact.stiffness", of_layer(kappa));
    scene.use(m, size.mesh.h * size.mesh.h / (quadratic ? 16 : 4));
    const auto element = [&](const geometry::TetMesh& mesh, const geometry::Snap& snap = {}) {
      return quadratic ? geometry::with_midsides(mesh, snap) : mesh;
    };
    const Solved s = solve(scene, [&](model::ModelInput& input) {
      const std::vector<double> lateral = size.mesh.outwards(R);
      set_mesh(input, "block", element(cylinder ? cylinder_block(R, size.mesh) : grid_block(lateral, lateral, size.mesh.downwards(R))));
      geometry::TetMesh octant = ball_octant(R, size.mesh.coarser());
      octant = element(octant, [R](const Vec3& a, const Vec3& b, const Vec3& x) -> Vec3 {
        const bool on_sphere = std::abs(a.norm() - R) < 1e-9 * R && std::abs(b.norm() - R) < 1e-9 * R;
        return on_sphere ? Vec3(R * x.normalized()) : x;
      });
      for (Vec3& x : octant.points) x[2] += R + gap;
      set_mesh(input, "ball", octant);
      if (const std::string file = b.option("mesh", ""); !file.empty()) write_meshes(file, input);
    });
    const double quarter = std::abs(s.fields.at("supports/ball_z")), F = 4 * quarter;
    const Hertz exact = bench::hertz(F, R, e_star);
    const Traction at = nodal_traction(
        s, "block", [](const Vec3& x) { return std::abs(x[2]) < 1e-9; }, quadratic);
    const double whole = l2_error(at, exact, exact.a), inner = l2_error(at, exact, 0.9 * exact.a);
    const double peak = at.peak();
    const double radius =
        std::sqrt(2.5 * sample_mean(s, m.effect, [](const Vec3& x) { return x.head<2>().squaredNorm(); }));  // int p r^2 dA = 2/5 a^2 F
    const auto gate = [&](double g) { return m.gated ? g : NAN; };
    const std::string name = fmt::format("{}{}{}", size.name, cylinder ? ", cylinder" : "", quadratic ? ", quadratic" : "");
    b.emit(s.row(name, m, "pressure L2, r <= a", whole, 0, whole, gate(quadratic ? NAN : size.l2)));
    b.emit(s.row(name, m, "pressure L2, r <= 0.9 a", inner, 0, inner, gate(quadratic ? size.l2 : NAN)));
    b.emit(s.row(name, m, "peak pressure", peak, exact.p0, std::abs(peak / exact.p0 - 1), gate(quadratic || std::isnan(size.l2) ? size.l2 : 0.02)));
    b.emit(s.row(name, m, "contact radius", radius, exact.a, std::abs(radius / exact.a - 1), gate(0.01)));
    const double contact = s.fields.at(m.effect + "/force_ball_z");
    b.emit(s.row(name, m, "contact force", contact, quarter, std::abs(contact / quarter - 1), gate(1e-10)));
    const double iterations = static_cast<double>(s.newton);
    b.emit(s.row(name, m, "Newton iterations", iterations, NAN, iterations, std::string_view(size.name) == "isaac" ? gate(12) : NAN));
    b.emit(s.row(name, m, "contact share of time", s.contact_share, NAN, s.contact_share, size.mesh.h > 0.01 ? NAN : gate(0.05)));
    if (s.converged) figure.add(m.name, size.name, at, exact);
    if (!s.converged) continue;
    const std::string file = fmt::format("{}{}{}_{}", size.name, cylinder ? "_cylinder" : "", quadratic ? "_quadratic" : "", m.name);
    b.draw(file + ".csv", [&](const std::string& path) { write_nodes(path, at, exact); });
    b.draw(file + ".png", [&](const std::string& path) {
      write_pressure_map(
          path,
          {"block", exact.a, 1.2 * exact.p0, fmt::format("{}, {}; circle: contact radius of Hertz, p0 = {:.4g} kPa", m.name, name, 1e-3 * exact.p0)},
          s, at);
    });
  }
}

}  // namespace

void hertz(const Bench& b) {
  const bool quadratic = b.order(1) == 2;
  const std::span<const Size> sizes = quadratic ? std::span<const Size>(kQuadraticSizes) : std::span<const Size>(kSizes);
  Figure figure;
  std::string rest = b.option("size", "coarse") + ",";
  for (std::size_t comma; (comma = rest.find(',')) != std::string::npos; rest.erase(0, comma + 1)) {
    const std::string wanted = rest.substr(0, comma);
    run(b, size_of(sizes, wanted), quadratic, figure);
  }
  const auto curve = [](double r) { return r < 1 ? std::sqrt(1 - r * r) : 0; };
  b.draw("pressure.svg",
         [&](const std::string& path) { write(path, profiles_svg(figure.panels, curve, "Hertz", "r / a", "pressure / p0", 1.6, 1.4)); });
}

}  // namespace mortise::bench
