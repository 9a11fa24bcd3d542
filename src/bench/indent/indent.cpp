// B11, B12: rigid punches on a half-space. The force follows from the depth, the pressure from the measured force.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/traction.h"
#include "geometry/midsides.h"

namespace mortise::bench {
namespace {

constexpr double kContact = 0.1, kDomain = 1;  // contact radius (of the cone: nearly) and size of the block [m]
constexpr double kFar = 3;                     // where the depth is counted from, in contact radii
constexpr int kSectors = 48;

struct Case {
  const char* name;
  double angle;         // between the axis and the flank [deg]; 90: flat
  double depth;         // of the tip [m]
  double inner, outer;  // pressure is compared on this ring, over the contact radius
  double gate;          // of the force
};
constexpr Case kCases[] = {{"flat punch", 90, 2e-3, 0, 0.8, 0.03}, {"cone, 88 deg", 88, 0.0055, 0.2, 1, 0.03}};

// Bends the grid's squares around the axis into circles where they are as wide as the contact, gradually inside and outside: an edge of the
// mesh then runs along a flat punch's rim, where the pressure is singular. (Through the corners of the squares go edges of the mesh.)
void round_off(geometry::TetMesh& block) {
  for (Vec3& x : block.points) {
    const double m = std::max(x[0], x[1]), length = std::hypot(x[0], x[1]);
    if (m == 0) continue;
    const double fraction = m < kContact ? m / kContact : (kDomain - m) / (kDomain - kContact);
    x.head<2>() *= 1 - fraction + fraction * m / length;
  }
}

struct Measured {
  Solved solved;
  double force = NAN, exact = NAN;      // at the depth [N]
  double l2 = NAN;                      // of the pressure, at the measured force
  double contact = NAN, support = NAN;  // of the quarter [N]
};

// With edges of length a/n at the contact.
Measured run(const Bench& b, const Case& c, const Method& m, int n, bool quadratic) {
  const double E = b.scene().number("materials.rubber.youngs_modulus"), nu = b.scene().number("materials.rubber.poisson_ratio"),
               e_star = E / (1 - nu * nu);
  const bool flat = c.angle == 90;
  const double slope = flat ? 0 : 1 / std::tan(c.angle * std::numbers::pi / 180), radius = flat ? kContact : 2 * kContact;
  const double h = kContact / n, d_hat = 0.08 * h, gap = 0.5 * d_hat;
  const double expected =
      (flat ? flat_punch_force(kContact, e_star, c.depth) : cone_force(slope, e_star, c.depth)) / (std::numbers::pi * kContact * kContact);
  SceneText scene = b.scene();
  scene.set(scene.moving_pin() + ".motion.translation.1", fmt::format("[0, 0, {:.17g}]", -c.depth - gap));
  scene.set("effects.mortar_contact.d_hat", d_hat);
  scene.set("effects.mortar_contact.stiffness", matched_stiffness(expected, d_hat, h, e_star, 4));
  scene.use(m, h * h / (quadratic ? 16 : 4));
  Measured out;
  out.solved = solve(scene, [&](model::ModelInput& input) {
    const std::vector<double> lateral = graded(h, 5 * n / 4, 3 * n / 2, kDomain);
    const std::vector<double> down = mirrored(graded(h, n / 2, 3 * n / 2, kDomain));
    geometry::TetMesh block = grid_block(lateral, lateral, down);
    round_off(block);
    set_mesh(input, "block", quadratic ? geometry::with_midsides(block) : block);
    geometry::TetMesh punch = punch_quarter(radius, slope * radius, kContact, kSectors);
    for (Vec3& x : punch.points) x[2] += gap;
    set_mesh(input, "punch", punch);
  });
  const Solved& s = out.solved;
  if (!s.converged) return out;
  out.contact = s.fields.at(m.effect + "/force_punch_z"), out.support = std::abs(s.fields.at("supports/block_z")), out.force = 4 * out.contact;
  const Traction t = nodal_traction(
      s, "block", [](const Vec3& x) { return std::abs(x[2]) < 1e-9; }, quadratic);
  const auto r = [](const Vec3& x) { return std::hypot(x[0], x[1]); };
  const double a = flat ? kContact : cone_radius(slope, e_star, out.force);
  // Depth is counted from the surface some radii away: what a half-space does beyond, a finite block does not.
  const Vec3 far = *std::min_element(t.now.begin(), t.now.end(),
                                     [&](const Vec3& x, const Vec3& y) { return std::abs(r(x) - kFar * a) < std::abs(r(y) - kFar * a); });
  double tip = 0;  // of the punch that the surface follows on average, weighted with the force [m]
  for (std::size_t i = 0; i < t.p.size(); ++i) tip += t.p[i] * t.area[i] * (t.now[i][2] - slope * r(t.now[i])) / t.force();
  const double depth = (far[2] - tip) / (1 - (flat ? flat_punch_surface(a, r(far)) : cone_surface(a, r(far))));
  out.exact = flat ? flat_punch_force(kContact, e_star, depth) : cone_force(slope, e_star, depth);
  out.l2 = t.l2([&](const Vec3& x) { return flat ? flat_punch_pressure(out.force, a, r(x)) : cone_pressure(slope, e_star, a, r(x)); },
                [&](const Vec3& x) { return r(x) >= c.inner * a && r(x) <= c.outer * a; });
  return out;
}

}  // namespace

void indent(const Bench& b) {
  const int cells = b.count("cells", 4);  // per contact radius
  const bool quadratic = b.order(1) == 2;
  for (const Case& c : kCases)
    for (const Method& m : b.methods()) {
      const auto gate = [&](double g) { return m.gated ? g : NAN; };
      double before = NAN;
      for (const int n : {cells, 2 * cells}) {
        const Measured at = run(b, c, m, n, quadratic);
        const Solved& s = at.solved;
        const std::string name = fmt::format("{}, h=a/{}{}", c.name, n, quadratic ? ", quadratic" : "");
        const double ratio = at.force / at.exact;
        b.emit(s.row(name, m, "force at the depth", at.force, at.exact, std::abs(ratio - 1), NAN));
        b.emit(s.row(name, m, "pressure L2", at.l2, 0, at.l2, NAN));
        b.emit(s.row(name, m, "contact force", at.contact, at.support, std::abs(at.contact / at.support - 1), gate(1e-10)));
        // Pressure is infinite at the rim and at the tip, so that the error of the force falls only like h.
        const double limit = 2 * ratio - before;
        if (n > cells) b.emit(s.row(fmt::format("{}, h -> 0", c.name), m, "force / exact force", limit, 1, std::abs(limit - 1), gate(c.gate)));
        before = ratio;
      }
    }
}

}  // namespace mortise::bench
