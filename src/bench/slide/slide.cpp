// H58: a block slides over an irregularly tessellated plane without friction. Whatever drags it is the contact's own roughness.
#include <fmt/format.h>

#include <algorithm>

#include "bench/all.h"
#include "bench/meshes.h"

namespace mortise::bench {
namespace {

struct Case {
  const char* name;
  double nu;
  const char *slave, *gradient;
  bool gated;
};
// With lateral strain the block's pinned top makes its lower face bulge; forces along its own normals then have a part along the plane.
// The plane's normals, or forces along the master's normal, know nothing of that.
constexpr Case kCases[] = {{"nu=0, slave block", 0, "block", "frozen", true},
                           {"nu=0.3, slave plane", 0.3, "plane", "frozen", true},
                           {"nu=0.3, slave block, exact", 0.3, "block", "exact", true},
                           {"nu=0.3, slave block, frozen", 0.3, "block", "frozen", false}};

}  // namespace

void slide(const Bench& b) {
  for (const Case& c : kCases)
    for (const Method& m : b.methods()) {
      if (m.effect != "mortar_contact" && std::string(c.gradient) == "exact") continue;  // the same again
      if (m.effect != "mortar_contact" && c.nu > 0 && std::string(c.slave) == "block") continue;
      SceneText scene = b.scene();
      scene.set("materials.rubber.poisson_ratio", c.nu);
      scene.set("effects.mortar_contact.pairs",
                fmt::format("[{{slave: {}, master: {}}}]", c.slave, std::string(c.slave) == "plane" ? "block" : "plane"));
      scene.set("effects.mortar_contact.gradient", c.gradient);
      scene.use(m, 0.01);
      double drag = 0, lowest = INFINITY, highest = 0;
      int step = 0;
      const Solved s = solve(
          scene,
          [](model::ModelInput& input) {
            set_mesh(input, "plane", jittered_block(Vec3(0, 0, -0.1), Vec3(2, 1, 0), {17, 9, 1}, 0.3, 7));
          },
          [&](const Snapshot& f) {
            if (++step <= 2) return;  // still coming down
            const double x = f.at(m.effect + "/force_block_x"), y = f.at(m.effect + "/force_block_y"), z = f.at(m.effect + "/force_block_z");
            drag = std::max(drag, std::hypot(x, y) / z);
            lowest = std::min(lowest, z), highest = std::max(highest, z);
          });
      b.emit(s.row(c.name, m, "drag / normal force", drag, 0, drag, m.gated && c.gated ? 1e-8 : NAN));
      b.emit(s.row(c.name, m, "ripple of normal force", highest / lowest - 1, 0, highest / lowest - 1, NAN));
    }
}

}  // namespace mortise::bench
