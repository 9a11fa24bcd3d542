// Quadratic tetrahedra through the whole chain.
#include <cstdio>

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// Largest sag of a cantilever of 10 x 1 x 1 under a force on its free end.
double sag(int order, const std::string& law, double nu, double end_traction) {
  Rig rig("mortise: 1\nname: cantilever\ntime: {mode: static, steps: 1}\nmaterials:\n  rubber: {model: " + law +
          ", youngs_modulus: 1 MPa, poisson_ratio: " + std::to_string(nu) +
          ", density: 1000}\nbodies:\n  beam: {type: soft, order: " + std::to_string(order) +
          ", shape: {box: {size: [10, 1, 1], edge_length: 0.5}}, material: rubber}\n"
          "effects:\n  elasticity: {}\n  pin: [{body: beam, where: {side: x_min}, axes: xyz}]\n"
          "  pressure_load: [{body: beam, where: {side: x_max}, traction: [0, 0, " +
          std::to_string(-end_traction) +
          "]}]\n"
          "solver: {relative_tolerance: 1e-10}\n");
  rig.step();
  const std::vector<double> points = rig.engine->points();
  double lowest = 0;
  for (std::size_t i = 2; i < points.size(); i += 3) lowest = std::min(lowest, points[i]);
  return -0.5 - lowest;
}

}  // namespace

// Timoshenko: F L^3/(3 E I) + F L/(k A G), k = 10 (1 + nu)/(12 + 11 nu). For nu > 0 the clamped end, which cannot contract sideways, takes away a
// percent. Two linear elements over the height lock.
TEST(Quadratic, CantileverFollowsBeamTheoryWhereLinearElementsLock) {
  const double F = 1, E = 1e6, L = 10, I = 1.0 / 12;
  for (double nu : {0.0, 0.3}) {
    const double G = E / (2 * (1 + nu)), k = 10 * (1 + nu) / (12 + 11 * nu), beam = F * L * L * L / (3 * E * I) + F * L / (k * G);
    const double two = sag(2, "linear", nu, F) / beam, one = sag(1, "linear", nu, F) / beam;
    std::printf("  nu %.2f: order 2 %.4f, order 1 %.4f of beam theory\n", nu, two, one);
    EXPECT_NEAR(two, 1, nu > 0 ? 0.015 : 1e-3) << nu;
    EXPECT_LT(one, 0.65 * two) << nu;
  }
  EXPECT_NEAR(sag(2, "neo_hookean", 0.3, F) / sag(2, "linear", 0.3, F), 1, 1e-3);
}

// A round body of curved tetrahedra falls, bounces and comes to rest on a plane and on a stiff block; nothing is passed through, and the
// contact carries the weight in the end.
TEST(Quadratic, RoundBodyComesToRestInContact) {
  for (const char* contact : {"mortar_contact: {pairs: [{slave: ball, master: floor}], d_hat: 10 mm, stiffness: 20 kPa}",
                              "barrier_contact: {d_hat: 10 mm, stiffness: 20 kPa}"}) {
    for (const char* floor :
         {"floor: {type: half_space}",
          "floor: {type: stiff, shape: {box: {size: [2, 2, 0.5], edge_length: 1}}, material: gel, position: [0.1, 0.2, -0.25]}"}) {
      const bool stiff = std::string(floor).find("stiff") != std::string::npos;
      Rig rig(std::string("mortise: 1\nname: rest\ntime: {step: 20 ms, steps: 40}\nmaterials:\n  gel: {youngs_modulus: 0.2 MPa, poisson_ratio: 0.4, "
                          "density: 1000}\nbodies:\n"
                          "  ball: {type: soft, order: 2, curved: true, shape: {sphere: {radius: 0.2, edge_length: 0.2}}, material: gel, position: "
                          "[0, 0, 0.22]}\n  ") +
              floor + "\neffects:\n  inertia: {}\n  gravity: {}\n  elasticity: {}\n  " + contact + "\n" +
              (stiff ? "  affine_body: {stiffness: 100 MPa}\n  pin: [{body: floor, where: {side: all}}]\n" : "") +
              "solver: {relative_tolerance: 1e-8}\n");
      double closest = 1, least = 1;
      for (int i = 0; i < 40; ++i) {
        rig.step();
        const Captured f = rig.fields();
        const std::string effect = std::string(contact).substr(0, std::string(contact).find(':'));
        closest = std::min(closest, f.at(effect + "/min_distance"));
        least = std::min(least, f.at("elasticity/det_F_min"));
        if (i == 39) {
          const double weight = 9.81 * 1000 * 4.0 / 3 * 3.14159265 * 0.008;
          EXPECT_NEAR(f.at(effect + "/force_ball_z") / weight, 1, 0.05) << contact << floor;
        }
      }
      EXPECT_GT(closest, 0) << contact << floor;
      EXPECT_GT(least, 0.3) << contact << floor;
    }
  }
}

// Friction on quadratic faces: a block slides down with g (sin - mu cos), or rests.
TEST(Quadratic, BlockSlidesUnderFriction) {
  for (double mu : {0.3, 0.6}) {
    Rig rig(
        "mortise: 1\nname: incline\ntime: {step: 10 ms, steps: 30}\nmaterials:\n  gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: "
        "1000}\nbodies:\n"
        "  block: {type: soft, order: 2, shape: {box: {size: [0.2, 0.2, 0.1], edge_length: 0.1}}, material: gel, position: [0, 0, 0.05086]}\n  "
        "floor: {type: half_space}\n"
        "effects:\n  inertia: {}\n  gravity: {acceleration: [4, 0, -9]}\n  elasticity: {}\n"
        "  mortar_contact: {pairs: [{slave: block, master: floor}], d_hat: 1 mm, stiffness: 20 kPa}\n  friction: {follows: mortar_contact, mu: " +
        std::to_string(mu) + "}\nsolver: {relative_tolerance: 1e-8}\n");
    rig.steps(30);
    const double speed = rig.fields().at("inertia/momentum_x") / 4;  // mass 4 kg
    if (mu < 4.0 / 9) {
      EXPECT_NEAR(speed, 0.3 * (4 - mu * 9), 0.01);
    } else {
      EXPECT_LT(std::abs(speed), 1e-8);
    }
  }
}

TEST(Quadratic, ScenesThatMakeNoSenseAreRefused) {
  const auto refused = [](const std::string& body, const std::string& why) {
    try {
      Rig rig(
          "mortise: 1\nname: no\ntime: {mode: static, steps: 1}\nmaterials:\n  gel: {youngs_modulus: 1 MPa, poisson_ratio: 0.3, density: "
          "1000}\nbodies:\n  body: " +
          body + "\neffects:\n  elasticity: {}\n");
      ADD_FAILURE() << body;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::scene);
      EXPECT_NE(std::string(e.what()).find(why), std::string::npos) << e.what();
    }
  };
  const std::string box = "shape: {box: {size: [1, 1, 1], edge_length: 1}}, material: gel}";
  refused("{type: soft, order: 3, " + box, "order");
  refused("{type: stiff, order: 2, " + box, "order");
  refused("{type: soft, order: 2, curved: true, " + box, "sphere, cylinder or capsule");
  refused("{type: soft, curved: true, shape: {sphere: {radius: 1, edge_length: 1}}, material: gel}", "order: 2");
}
