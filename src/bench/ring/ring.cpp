// B23: two rings pressed together. Bodies must start apart, so that the interference of a shrink fit is made by pressure q on the outer
// ring. Alone it would close by 2 q bore c^2/(E (c^2 - bore^2)); less the clearance, and with the gap g that the contact layer keeps, this
// is the interference D of Lame's formula.
#include <fmt/format.h>

#include <numbers>
#include <numeric>

#include "bench/all.h"
#include "bench/meshes.h"
#include "bench/reference.h"
#include "bench/traction.h"

namespace mortise::bench {
namespace {

constexpr double kInner = 1, kContact = 2, kOuter = 3, kThickness = 0.1;  // radii and thickness [m]
constexpr double kInterference = 0.01;                                    // without the gap [m]

std::vector<double> from(double lo, double hi) {
  std::vector<double> r = graded(0, 8, 0, hi - lo);
  for (double& x : r) x += lo;
  return r;
}

// Pressure on the outer ring's outside, facet by facet: a ball from far outside, so large that it is flat here, holds each and nothing of its
// neighbours, which lie behind it.
std::string outside(double q, int cells) {
  constexpr double kFar = 1e6, kSlack = 1e-9;
  const double half = 0.25 * std::numbers::pi / cells, reach = std::hypot(kFar, kOuter * std::sin(half), 0.5 * kThickness) + kSlack;
  std::string out;
  for (int k = 0; k < cells; ++k) {
    const double angle = half * (2 * k + 1), r = kOuter * std::cos(half) + kFar;
    out += fmt::format("{}{{body: outer, where: {{sphere: {{centre: [{:.17g}, {:.17g}, {:.17g}], radius: {:.17g}}}}}, pressure: {:.17g}}}",
                       k ? ", " : "[", r * std::cos(angle), r * std::sin(angle), 0.5 * kThickness, reach, q);
  }
  return out + "]";
}

}  // namespace

void ring(const Bench& b) {
  const double E = b.scene().number("materials.metal.youngs_modulus"), nu = b.scene().number("materials.metal.poisson_ratio");
  const double d_hat = b.scene().number("effects.mortar_contact.d_hat"), kappa = b.scene().number("effects.mortar_contact.stiffness"),
               clearance = 0.6 * d_hat, bore = kContact + clearance;
  const int cells = b.count("cells", 96);
  for (const bool strain : {false, true})
    for (const Method& m : b.methods()) {
      const double modulus = strain ? E / (1 - nu * nu) : E;
      const double q = (kInterference + clearance) * modulus * (kOuter * kOuter - bore * bore) / (2 * bore * kOuter * kOuter);
      // p and the gap depend on each other.
      double p = pressed_rings_pressure(kInner, kContact, bore, kOuter, kInterference, modulus);
      for (int i = 0; i < 100; ++i)
        p = pressed_rings_pressure(kInner, kContact, bore, kOuter, kInterference + d_hat * barrier_gap(p / kappa), modulus);
      SceneText scene = b.scene();
      if (strain)
        for (const char* body : {"inner", "outer"}) scene.add("effects.pin", fmt::format("{{body: {}, where: {{side: z_max}}, axes: z}}", body));
      scene.set("effects.pressure_load", outside(q, 3 * cells / 4));
      const double width = 0.5 * std::numbers::pi * kContact / cells;
      scene.use(m, width * kThickness / 2);
      const Solved s = solve(scene, [&](model::ModelInput& input) {
        set_mesh(input, "inner", ring_quarter(from(kInner, kContact), cells, {0, kThickness}));
        set_mesh(input, "outer", ring_quarter(from(bore, kOuter), 3 * cells / 4, {0, kThickness}));
      });
      const Traction t = nodal_traction(s, "inner", [](const Vec3& x) { return x.head<2>().norm() > kContact - 1e-9; });
      const double mean = t.force() / std::accumulate(t.area.begin(), t.area.end(), 0.0);
      const std::string name = strain ? "plane strain" : "plane stress";
      b.emit(s.row(name, m, "mean pressure", mean, p, std::abs(mean / p - 1), m.gated ? 0.01 : NAN));
      const double l2 = t.l2([&](const Vec3&) { return p; }, [](const Vec3&) { return true; });
      b.emit(s.row(name, m, "pressure L2", l2, 0, l2, NAN));
      const double contact = std::hypot(s.fields.at(m.effect + "/force_inner_x"), s.fields.at(m.effect + "/force_inner_y"));
      const double support = std::hypot(s.fields.at("supports/inner_x"), s.fields.at("supports/inner_y"));
      b.emit(s.row(name, m, "contact force", contact, support, std::abs(contact / support - 1), m.gated ? 1e-10 : NAN));
    }
}

}  // namespace mortise::bench
