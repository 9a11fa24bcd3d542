// B14: pin in a bore (code_aster SSNV127, without friction), plane strain: contact over an angle that no half-space knows. Angle and pressure
// are computed from the measured force; the gap that the contact layer keeps takes from the clearance.
#include <fmt/format.h>

#include <numbers>

#include "base/error.h"
#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/traction.h"
#include "geometry/midsides.h"

namespace mortise::bench {
namespace {

// Bore, core of the pin, half the width of the plate, clearance [m]. The core is held: nearly the point force of the theory. The plate's sides change
// the strains at the bore by about (kRadius/kPlate)^2.
constexpr double kRadius = 1, kCore = 0.1, kPlate = 20, kClearance = 0.01;
constexpr double kFine = 75 * std::numbers::pi / 180;  // from the direction of the force [rad]

std::vector<double> from(double lo, std::vector<double> lengths) {
  for (double& x : lengths) x += lo;
  return lengths;
}

// Angles from the x axis, -90 degrees being the direction of the force: fine ones first.
std::vector<double> angles(int fine, int coarse) { return from(-0.5 * std::numbers::pi, graded(kFine / fine, fine, coarse, std::numbers::pi)); }

// A half ring whose outside becomes a square.
geometry::TetMesh plate(double bore, const std::vector<double>& r, const std::vector<double>& angles, const std::vector<double>& z) {
  geometry::TetMesh mesh = ring_sector(r, angles, z);
  for (Vec3& x : mesh.points) {
    const double length = x.head<2>().norm(), fraction = (length - bore) / (kPlate - bore);
    const double side = kPlate * length / std::max(std::abs(x[0]), std::abs(x[1]));  // along the same ray
    const double at = (1 - fraction) * bore + fraction * side;
    x.head<2>() *= fraction > 1e-12 ? at / length : 1;
  }
  return mesh;
}

}  // namespace

void pin(const Bench& b) {
  const bool quadratic = b.order(2) == 2;
  const int cells = b.count("cells", quadratic ? 32 : 64);  // over the fine angle
  const double E = b.scene().number("materials.metal.youngs_modulus"), nu = b.scene().number("materials.metal.poisson_ratio"),
               modulus = E / (1 - nu * nu);
  const double bore = kRadius + kClearance, h = kRadius * kFine / cells, thickness = h;
  const double d_hat = b.number("layer", 0.04) * kClearance, gap = 0.5 * d_hat, expected = 0.7 * modulus * kClearance / kRadius;
  for (const Method& m : b.methods()) {
    SceneText scene = b.scene();
    scene.set(scene.moving_pin() + ".where.sphere.radius", std::hypot(kCore, thickness) * 1.001 + kClearance);
    scene.set("effects.mortar_contact.d_hat", d_hat);
    scene.set("effects.mortar_contact.stiffness", matched_stiffness(expected, d_hat, h, 0.5 * modulus, b.number("k", quadratic ? 24 : 4)));
    scene.use(m, h * thickness / (quadratic ? 8 : 2));
    const auto element = [&](const geometry::TetMesh& mesh, double radius) {
      if (!quadratic) return mesh;
      return geometry::with_midsides(mesh, [radius](const Vec3& a, const Vec3& b, const Vec3& x) -> Vec3 {
        const auto on = [&](const Vec3& y) { return std::abs(y.head<2>().norm() - radius) < 1e-9; };
        if (!on(a) || !on(b)) return x;
        const double stretch = radius / x.head<2>().norm();
        return {x[0] * stretch, x[1] * stretch, x[2]};
      });
    };
    const double down = kClearance - gap;  // of the pin's centre: nearly in contact
    const Solved s = solve(scene, [&](model::ModelInput& input) {
      std::vector<double> inward = mirrored(graded(h, 3, cells / 4, kRadius - kCore));
      set_mesh(
          input, "plate",
          element(plate(bore, from(bore, graded(1.1 * h, 2, cells / 2, kPlate - bore)), angles(cells * 9 / 10, cells / 2), {0, thickness}), bore));
      geometry::TetMesh disc = element(ring_sector(from(kRadius, inward), angles(cells, cells / 2), {0, thickness}), kRadius);
      for (Vec3& x : disc.points) x[1] -= down;
      set_mesh(input, "pin", disc);
    });
    const double half = std::abs(s.fields.at("supports/pin_y")), Q = 2 * half / thickness;
    const double exact = pin_half_angle(modulus * (kClearance - mean_gap(s, m.effect)) / Q);
    const Traction t = nodal_traction(
        s, "pin", [&](const Vec3& x) { return std::abs(std::hypot(x[0], x[1] + down) - kRadius) < 1e-9; }, quadratic);
    // From the direction of the force, about the pin's centre: as its core has moved, quadratic: at rest.
    const double now = -down + b.scene().number(b.scene().moving_pin() + ".motion.translation.1.1"), centre = quadratic ? -down : now;
    const auto angle = [](const Vec3& x, double centre) { return std::atan2(std::abs(x[0]), centre - x[1]); };
    const double peak = Q / kRadius * pin_pressure(exact, 0);
    const double l2 = t.l2([&](const Vec3& x) { return Q / kRadius * pin_pressure(exact, angle(x, centre)); },
                           [&](const Vec3& x) { return angle(x, centre) <= exact; });
    const double reached = pin_half_angle_of_moment(sample_mean(s, m.effect, [&](const Vec3& x) { return std::pow(std::sin(angle(x, now)), 2); }));
    const auto gate = [&](double g) { return m.gated ? g : NAN; };
    const std::string name = fmt::format("{} cells{}", cells, quadratic ? ", quadratic" : "");
    constexpr double kDegree = std::numbers::pi / 180;
    b.emit(s.row(name, m, "half-angle [deg]", reached / kDegree, exact / kDegree, std::abs(reached - exact) / kDegree, gate(2)));
    b.emit(s.row(name, m, "pressure L2", l2, 0, l2, gate(quadratic ? 0.02 : NAN)));
    b.emit(s.row(name, m, "peak pressure", t.peak(), peak, std::abs(t.peak() / peak - 1), gate(quadratic ? 0.02 : NAN)));
    const double contact = s.fields.at(m.effect + "/force_pin_y");
    b.emit(s.row(name, m, "contact force", contact, half, std::abs(contact / half - 1), gate(1e-10)));
  }
}

}  // namespace mortise::bench
