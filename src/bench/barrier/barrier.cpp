// B27: one block on a plane under uniform pressure p. Every gap must solve kappa phi(g/d_hat) = p.
#include <fmt/format.h>

#include <algorithm>

#include "bench/all.h"
#include "bench/reference.h"

namespace mortise::bench {

void barrier(const Bench& b) {
  const double p = b.scene().number("effects.pressure_load.0.pressure"), d_hat = b.scene().number("effects.mortar_contact.d_hat");
  for (const Method& m : b.methods())
    for (double ratio : {1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0}) {
      SceneText scene = b.scene();
      scene.set("effects.mortar_contact.stiffness", p / ratio);
      scene.use(m, 1.0 / 16);
      const Solved s = solve(scene);
      const double wanted = d_hat * barrier_gap(ratio);
      double worst = wanted, sum = 0;
      const auto gaps = s.fields.row.find(m.effect + "/gap");
      const bool any = gaps != s.fields.row.end() && !gaps->second.empty();
      if (any)
        for (double g : gaps->second) {
          sum += g;
          if (std::abs(g - wanted) > std::abs(worst - wanted)) worst = g;
        }
      // The classic form has no areas: its gaps depend on the mesh and are shown only.
      const double gate = m.weights == "classic" ? NAN : 1e-8;
      b.emit(s.row(fmt::format("p/kappa={:g}", ratio), m, "gap (worst sample)", any ? worst : NAN, wanted, any ? std::abs(worst / wanted - 1) : NAN,
                   gate));
    }
}

}  // namespace mortise::bench
