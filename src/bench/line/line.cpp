// B08: cylinder on a block in plane strain (NAFEMS CB-1, code_aster SSNP154). a and p0 are computed from the measured force.
#include <fmt/format.h>

#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/size.h"
#include "bench/traction.h"

namespace mortise::bench {
namespace {

constexpr Size kSizes[] = {{"coarse", {0.8e-3, 10, 8, 10}, 1e-4, 0.05}, {"fine", {0.4e-3, 20, 10, 14}, 5e-5, 0.05}};
constexpr double kGate = 0.02;                                // of peak and half-width
constexpr double kRadius = 0.05, kWidth = 0.1, kDepth = 0.2;  // of the block: half its width [m]
constexpr double kExpected = 3585e6;                          // p0 under 35 kN/mm, for the choice of kappa only [Pa]

}  // namespace

void line(const Bench& b) {
  const Size& size = size_of(kSizes, b.option("size", "coarse"));
  const double h = size.mesh.h;
  const auto compliance = [&](const std::string& material) {
    const double nu = b.scene().number("materials." + material + ".poisson_ratio");
    return (1 - nu * nu) / b.scene().number("materials." + material + ".youngs_modulus");
  };
  const double e_star = 1 / (compliance("steel") + compliance("aluminium"));
  const double d_hat = b.number("layer", 1) * size.d_hat, gap = 0.1 * size.d_hat, thickness = 6 * h;
  for (const Method& m : b.methods()) {
    SceneText scene = b.scene();
    scene.set("effects.mortar_contact.d_hat", d_hat);
    scene.set("effects.mortar_contact.stiffness", matched_stiffness(kExpected, d_hat, h, e_star, 4));
    scene.use(m, h * h / 4);
    const Solved s = solve(scene, [&](model::ModelInput& input) {
      set_mesh(input, "block", grid_block(size.mesh.outwards(kWidth), graded(0, 6, 0, thickness), size.mesh.downwards(kDepth)));
      geometry::TetMesh quarter = cylinder_quarter(kRadius, size.mesh.coarser(), graded(0, 5, 0, thickness));
      for (Vec3& x : quarter.points) x[2] += kRadius + gap;
      set_mesh(input, "roller", quarter);
    });
    const double half = std::abs(s.fields.at("supports/roller_z")), P = 2 * half / thickness;
    const Hertz exact = hertz_line(P, kRadius, e_star);
    const Traction t = nodal_traction(s, "block", [](const Vec3& x) { return std::abs(x[2]) < 1e-9; });
    const double l2 = t.l2([&](const Vec3& x) { return exact.pressure(x[0]); }, [&](const Vec3& x) { return x[0] <= exact.a; });
    // Half-width from the second moment of the forces on the samples: int p x^2 dx = a^2 P/4.
    const double width = 2 * std::sqrt(sample_mean(s, m.effect, [](const Vec3& x) { return x[0] * x[0]; }));
    const auto gate = [&](double g) { return m.gated ? g : NAN; };
    b.emit(s.row(size.name, m, "line load [N/m]", P, 35e6, std::abs(P / 35e6 - 1), NAN));
    b.emit(s.row(size.name, m, "pressure L2, x <= a", l2, 0, l2, gate(size.l2)));
    b.emit(s.row(size.name, m, "peak pressure", t.peak(), exact.p0, std::abs(t.peak() / exact.p0 - 1), gate(kGate)));
    b.emit(s.row(size.name, m, "half-width", width, exact.a, std::abs(width / exact.a - 1), gate(kGate)));
    const double contact = s.fields.at(m.effect + "/force_roller_z");
    b.emit(s.row(size.name, m, "contact force", contact, half, std::abs(contact / half - 1), gate(1e-10)));
  }
}

}  // namespace mortise::bench
