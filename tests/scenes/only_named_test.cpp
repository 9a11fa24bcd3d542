// What a scene does not name does not exist: no object, no buffer, no kernel launch, no report.
#include "device/device.h"
#include "engine/choose.h"
#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

const char* kAll = R"(
mortise: 1
name: all
time: {step: 5 ms, steps: 3}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.05}}, material: gel, position: [0, 0, 0.0505]}
  cube: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.1}}, material: gel, position: [0.3, 0, 0.0505]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {stiffness: 1 MPa}
  pin: [{body: pad, where: {side: z_max}, axes: xy}]
  pressure_load: [{body: pad, where: {side: z_max}, pressure: 10 Pa}]
  barrier_contact: {d_hat: 1 mm, stiffness: 10 kPa}
  friction: {follows: barrier_contact, mu: 0.3}
)";

// Scenes that lack one effect: the line to drop, and bodies that cannot do without it.
struct Without {
  const char* effect;
  std::vector<std::string> drop;
};
const Without kWithout[] = {{"gravity", {"gravity:"}},
                            {"affine_body", {"affine_body:", "cube:"}},
                            {"pin", {"pin:"}},
                            {"pressure_load", {"pressure_load:"}},
                            {"friction", {"friction:"}},
                            {"barrier_contact", {"barrier_contact:", "friction:"}},
                            {"elasticity", {"elasticity:", "pad:", "pin:", "pressure_load:"}}};

std::string without(const std::vector<std::string>& drop) {
  std::istringstream in(kAll);
  std::string out, line;
  while (std::getline(in, line)) {
    const std::string key = line.substr(std::min(line.find_first_not_of(' '), line.size()));
    const bool gone =
        line.size() > 2 && line[2] != ' ' && std::any_of(drop.begin(), drop.end(), [&](const std::string& d) { return key.rfind(d, 0) == 0; });
    if (!gone) out += line + "\n";
  }
  return out;
}

bool launched(std::string effect) {
  if (effect == "barrier_contact") effect = "contact";  // what it shares with the guard of mortar_contact
  for (const device::LaunchCount& l : device::launch_counts())
    if (l.name.rfind(effect + ".", 0) == 0) return true;
  return false;
}

bool planned(const Rig& rig, const std::string& effect) {
  for (const engine::PlanItem& item : rig.engine->plan())
    if (item.effect == effect) return true;
  return false;
}

// Groups of scalars and rows that carry the effect's name, and its own point fields.
bool reported(const Captured& c, const std::string& effect) {
  for (const auto& [name, value] : c.number)
    if (name.rfind(effect + "/", 0) == 0 || name.rfind("balance/" + effect + "_", 0) == 0) return true;
  for (const auto& [name, value] : c.row)
    if (name.rfind(effect + "/", 0) == 0) return true;
  return false;
}

}  // namespace

// Of the program's own engine: the CUDA module counts by itself.
class OnlyNamed : public ::testing::Test {
 protected:
  void SetUp() override {
    if (engine::chosen().device.kind == "cuda") GTEST_SKIP() << "launches and memory are those of the program's own engine";
  }
};

TEST_F(OnlyNamed, EverythingNamedIsThere) {
  device::reset_launch_counts();
  Rig rig(kAll);
  rig.steps(2);
  const Captured c = rig.fields();
  for (const Without& w : kWithout) {
    EXPECT_TRUE(planned(rig, w.effect)) << w.effect;
    EXPECT_TRUE(launched(w.effect)) << w.effect;
    EXPECT_TRUE(reported(c, w.effect)) << w.effect;
  }
}

TEST_F(OnlyNamed, WhatIsNotNamedIsNowhere) {
  for (const Without& w : kWithout) {
    device::reset_launch_counts();
    const std::size_t before = device::memory_use().now;
    std::size_t held;
    {
      Rig rig(without(w.drop));
      rig.steps(2);
      held = device::memory_use().now - before;
      EXPECT_FALSE(planned(rig, w.effect)) << w.effect;
      EXPECT_FALSE(launched(w.effect)) << w.effect;
      EXPECT_FALSE(reported(rig.fields(), w.effect)) << w.effect;
    }
    Rig all(kAll);
    all.steps(2);
    // A pad that nothing holds has masses between its nodes, which one that is held has not.
    if (std::string(w.effect) != "pin") {
      EXPECT_LT(held, device::memory_use().now - before) << w.effect;
    }
  }
}
