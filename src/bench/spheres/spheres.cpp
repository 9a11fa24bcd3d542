// B06: two equal balls (code_aster SSNV104). a and p0 are computed from the measured force, as in hertz, and from the approach.
#include <fmt/format.h>

#include <numbers>

#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/traction.h"

namespace mortise::bench {
namespace {

constexpr double kRadius = 0.05, kEffective = 0.5 * kRadius;  // 1/R_e = 1/R + 1/R [m]

struct Case {
  const char* name;
  double approach;          // [m]
  double peak, radius, l2;  // gates
};
// The second one, a/R = 0.2, is beyond small strains: Hertz's profile no longer fits.
constexpr Case kCases[] = {{"approach R/500", 1e-4, 0.01, 0.01, 0.05}, {"approach 0.08 R", 4e-3, 0.03, NAN, NAN}};

}  // namespace

void spheres(const Bench& b) {
  const int cells = b.count("cells", 6);  // per contact radius
  const double layer = b.number("layer", 1);
  const double E = b.scene().number("materials.metal.youngs_modulus"), nu = b.scene().number("materials.metal.poisson_ratio"),
               e_star = E / (2 * (1 - nu * nu));
  for (const Case& c : kCases)
    for (const Method& m : b.methods()) {
      const double a = std::sqrt(kEffective * c.approach), p0 = 2 * e_star * a / (std::numbers::pi * kEffective);
      const Spot spot{a / cells, 4 * cells / 3, 7, 10};
      const double usual = 0.1 * spot.h, d_hat = layer * usual, gap = 0.1 * usual;
      SceneText scene = b.scene();
      scene.set(scene.moving_pin() + ".motion.translation.1", fmt::format("[0, 0, {:.17g}]", -c.approach));
      scene.set("effects.mortar_contact.d_hat", d_hat);
      scene.set("effects.mortar_contact.stiffness", matched_stiffness(p0, d_hat, spot.h, e_star, 4));
      scene.use(m, spot.h * spot.h / 4);
      const Solved s = solve(scene, [&](model::ModelInput& input) {
        geometry::TetMesh lower = upside_down(ball_octant(kRadius, spot)), upper = ball_octant(kRadius, spot.coarser());
        for (Vec3& x : lower.points) x[2] -= kRadius;
        for (Vec3& x : upper.points) x[2] += kRadius + gap;
        set_mesh(input, "lower", lower), set_mesh(input, "upper", upper);
      });
      const double quarter = std::abs(s.fields.at("supports/upper_z"));
      const Hertz exact = bench::hertz(4 * quarter, kEffective, e_star);
      const Traction t =
          nodal_traction(s, "lower", [](const Vec3& x) { return std::abs((x + Vec3(0, 0, kRadius)).norm() - kRadius) < 1e-9 * kRadius; });
      const auto r = [](const Vec3& x) { return x.head<2>().norm(); };
      const double l2 = t.l2([&](const Vec3& x) { return exact.pressure(r(x)); }, [&](const Vec3& x) { return r(x) <= exact.a; });
      const double radius = std::sqrt(2.5 * sample_mean(s, m.effect, [&](const Vec3& x) { return r(x) * r(x); }));  // int p r^2 dA = 2/5 a^2 F
      // What the balls have come closer is what their flat sides moved, less the gap at the start, plus what is left of it.
      const double approach = c.approach - gap + mean_gap(s, m.effect), p_approach = 2 * e_star * std::sqrt(approach / kEffective) / std::numbers::pi;
      const auto gate = [&](double g) { return m.gated ? g : NAN; };
      b.emit(s.row(c.name, m, "pressure L2, r <= a", l2, 0, l2, gate(c.l2)));
      b.emit(s.row(c.name, m, "peak pressure", t.peak(), exact.p0, std::abs(t.peak() / exact.p0 - 1), gate(c.peak)));
      b.emit(s.row(c.name, m, "peak of the approach", t.peak(), p_approach, std::abs(t.peak() / p_approach - 1), NAN));
      b.emit(s.row(c.name, m, "contact radius", radius, exact.a, std::abs(radius / exact.a - 1), gate(c.radius)));
      const double contact = s.fields.at(m.effect + "/force_upper_z");
      b.emit(s.row(c.name, m, "contact force", contact, quarter, std::abs(contact / quarter - 1), gate(1e-10)));
    }
}

}  // namespace mortise::bench
