// Nearly incompressible bodies that bend, shear and are pressed: what the elements find of the deflection, and what that costs.
// Quadratic elements have edges twice as long, so as many nodes.
#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "bench/all.h"
#include "geometry/midsides.h"
#include "geometry/primitives.h"
#include "geometry/tetrahedralise.h"
#include "geometry/topology.h"

namespace mortise::bench {
namespace {

struct Elements {
  const char* name;
  int order;
  const char* volumetric;
};
constexpr Elements kElements[] = {
    {"linear_full", 1, "full"}, {"linear_averaged", 1, "averaged"}, {"quadratic_full", 2, "full"}, {"quadratic_averaged", 2, "averaged"}};

constexpr double kRatios[] = {0.3, 0.49, 0.499, 0.4999};

struct Case {
  const char* name;
  std::vector<int> cells;              // linear elements over the height
  double reference[4];                 // [m], at kRatios: beam theory, or what quadratic elements find on meshes four and two times finer than
                                       // the finest here
  double gate_linear, gate_quadratic;  // with averages
  void (*prepare)(SceneText&);
  geometry::TetMesh (*mesh)(int cells);
  Vec3 at;  // where the deflection is taken: of the node that is nearest
};

geometry::TetMesh at_origin(geometry::TetMesh mesh, const Vec3& size) {
  for (Vec3& x : mesh.points) x += 0.5 * size;
  return mesh;
}

geometry::TetMesh beam(int n) { return geometry::box({10, 1, 1}, std::array<Index, 3>{10 * n, n, n}); }
geometry::TetMesh meshed_beam(int n) {
  geometry::TetrahedraliseOptions options;
  options.edge_length = options.surface_edge_length = 1.0 / n;
  return geometry::tetrahedralise(geometry::surface_of(geometry::box({10, 1, 1}, std::array<Index, 3>{1, 1, 1})), options, "beam");
}

// Cook's membrane in plane strain: a tapered panel, 48 wide, 44 high at the held end and 16 at the other, two cells thick.
constexpr double kThickness = 8;
geometry::TetMesh panel(int n) {
  geometry::TetMesh mesh = at_origin(geometry::box({48, kThickness, 1}, std::array<Index, 3>{n, 2, n}), {48, kThickness, 1});
  for (Vec3& x : mesh.points) {
    const double low = 44 * x[0] / 48, high = 44 + 16 * x[0] / 48;
    x[2] = low + x[2] * (high - low);
  }
  return mesh;
}
void panel_supports(SceneText& scene) {
  scene.set("effects.pin",
            "[{body: body, where: {side: x_min}}, {body: body, where: {side: y_min}, axes: y}, {body: body, where: {side: "
            "y_max}, axes: y}]");
  scene.set("effects.pressure_load", "[{body: body, where: {side: x_max}, traction: [0, 0, 1000]}]");
}

// A quarter of a bonded pad, 4 x 4 x 1, under pressure on a square of 2 x 2.
geometry::TetMesh pad(int n) { return at_origin(geometry::box({2, 2, 1}, std::array<Index, 3>{2 * n, 2 * n, n}), {2, 2, 1}); }
void pad_supports(SceneText& scene) {
  scene.set("effects.pin",
            "[{body: body, where: {side: z_min}}, {body: body, where: {side: x_min}, axes: x}, {body: body, where: {side: "
            "y_min}, axes: y}]");
  scene.set("effects.pressure_load", "[{body: body, where: {box: {min: [-0.01, -0.01, 0.99], max: [1.01, 1.01, 1.01]}}, pressure: 1000}]");
}

// Timoshenko: F L^3/(3 E I) + F L/(k A G), k = 10 (1 + nu)/(12 + 11 nu).
double beam_theory(double nu) {
  constexpr double F = 1, E = 1e6, L = 10, I = 1.0 / 12;
  const double G = E / (2 * (1 + nu)), k = 10 * (1 + nu) / (12 + 11 * nu);
  return F * L * L * L / (3 * E * I) + F * L / (k * G);
}

double deflection(const Solved& s, const Vec3& at) {
  const std::vector<Vec3>& X = s.input.bodies[0].nodes;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < X.size(); ++i)
    if ((X[i] - at).norm() < (X[nearest] - at).norm()) nearest = i;
  return std::abs(s.points[3 * nearest + 2] - X[nearest][2]);
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"cantilever", {4, 8}, {beam_theory(0.3), beam_theory(0.49), beam_theory(0.499), beam_theory(0.4999)}, 0.1, 0.03, nullptr, beam, {5, 0, 0}},
      {"cantilever, meshed",
       {4},
       {beam_theory(0.3), beam_theory(0.49), beam_theory(0.499), beam_theory(0.4999)},
       0.15,
       0.03,
       nullptr,
       meshed_beam,
       {5, 0, 0}},
      {"Cook's membrane", {8, 16}, {0.36839, 0.31465, 0.31123, 0.31088}, 0.12, 0.025, panel_supports, panel, {48, 0, 60}},
      {"bonded pad", {4, 8}, {7.9939e-4, 4.8083e-4, 4.6080e-4, 4.5877e-4}, 0.02, 0.04, pad_supports, pad, {0, 0, 1}}};
  return all;
}

std::vector<Elements> wanted(const Bench& b) {
  const std::string names = "," + b.option("methods", "") + ",";
  std::vector<Elements> out;
  for (const Elements& e : kElements)
    if (names == ",," || names.find("," + std::string(e.name) + ",") != std::string::npos) out.push_back(e);
  if (out.empty()) throw Error(Exit::usage, "--set methods: there are linear_full, linear_averaged, quadratic_full, quadratic_averaged");
  return out;
}

}  // namespace

void locking(const Bench& b) {
  const std::string only = b.option("case", "");
  const int finer = b.count("finer", 1);
  for (const Case& c : cases()) {
    if (!only.empty() && only != c.name) continue;
    for (const int cells : c.cells)
      for (std::size_t r = 0; r < std::size(kRatios); ++r)
        for (const Elements& e : wanted(b)) {
          SceneText scene = b.scene();
          scene.set("materials.gel.poisson_ratio", kRatios[r]);
          scene.set("materials.gel.volumetric", e.volumetric);
          if (c.prepare) c.prepare(scene);
          const Solved s = solve(scene, [&](model::ModelInput& input) {
            geometry::TetMesh mesh = c.mesh(finer * cells / e.order);
            set_mesh(input, "body", e.order == 1 ? mesh : geometry::with_midsides(mesh));
          });
          const double found = deflection(s, c.at), error = std::abs(found / c.reference[r] - 1);
          const bool averaged = std::string(e.volumetric) == "averaged";
          b.emit(s.row(fmt::format("{}, {} cells, nu={:g}", c.name, finer * cells, kRatios[r]), {e.name, "", ""}, "deflection", found, c.reference[r],
                       error, averaged ? (e.order == 1 ? c.gate_linear : c.gate_quadratic) : NAN));
        }
  }
}

}  // namespace mortise::bench
