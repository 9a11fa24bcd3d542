// Nearly incompressible bodies bend and are pressed as they should, with nothing set but their material.
#include <cstdio>

#include "rig.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

// Mean deflection of the end of a cantilever of 10 x 1 x 1 over that of a Timoshenko beam.
double deflection(double nu, const std::string& body, const std::vector<std::string>& set = {}) {
  const double F = 1e-3, E = 1e3, L = 10, I = 1.0 / 12;
  Rig rig(
      "mortise: 1\nname: cantilever\ntime: {mode: static, steps: 1}\nmaterials: {gel: {model: linear, youngs_modulus: 1 kPa, "
      "poisson_ratio: " +
          std::to_string(nu) + ", density: 1000}}\nbodies:\n  beam: {type: soft, material: gel, " + body +
          "}\neffects:\n  elasticity: {}\n  pin: [{body: beam, where: {side: x_min}}]\n"
          "  pressure_load: [{body: beam, where: {side: x_max}, traction: [0, 0, -1e-3]}]\nsolver: {relative_tolerance: 1e-8}\n",
      set);
  rig.step();
  const std::vector<double> y = rig.engine->points();
  const std::vector<Vec3>& X = rig.input.bodies[0].nodes;
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < X.size(); ++i)
    if (std::abs(X[i].x() - L / 2) < 1e-9) sum += X[i].z() - y[3 * i + 2], ++n;
  const double G = E / (2 * (1 + nu)), k = 10 * (1 + nu) / (12 + 11 * nu);
  return sum / n / (F * L * L * L / (3 * E * I) + F * L / (k * G));
}

const std::string kLinear = "shape: {box: {size: [10, 1, 1], edge_length: 0.25}}",
                  kQuadratic = "order: 2, shape: {box: {size: [10, 1, 1], edge_length: 0.5}}";

}  // namespace

// Four linear tetrahedra over the height, or as many nodes of quadratic ones. Without averages mirrored boxes lose another tenth.
TEST(Locking, ACantileverBendsAtEveryPoissonRatio) {
  for (double nu : {0.3, 0.45, 0.49, 0.499, 0.4999}) {
    const double linear = deflection(nu, kLinear), quadratic = deflection(nu, kQuadratic),
                 full = deflection(nu, kLinear, {"materials.gel.volumetric=full"});
    std::printf("  nu %.4f: linear %.3f (full %.3f), quadratic %.3f of beam theory\n", nu, linear, full, quadratic);
    EXPECT_GT(linear, nu > 0.4 ? 0.9 : 0.84) << nu;
    EXPECT_NEAR(quadratic, 1, 0.03) << nu;
    if (nu > 0.4) {
      EXPECT_LT(full, linear - 0.07) << nu;
    }
  }
}

// Tetrahedra as a mesher leaves them: without averages nothing moves any more.
TEST(Locking, UnstructuredMeshesDoNotLock) {
  const std::string file = ::testing::TempDir() + "locking_beam.obj";
  FILE* out = std::fopen(file.c_str(), "w");
  for (int i = 0; i < 8; ++i) std::fprintf(out, "v %g %g %g\n", i & 1 ? 5.0 : -5.0, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
  std::fputs("f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n", out);
  std::fclose(out);
  const std::string body = "shape: {mesh: {file: " + file + ", edge_length: 0.3, surface_edge_length: 0.3}}";
  const double averaged = deflection(0.4999, body), full = deflection(0.4999, body, {"materials.gel.volumetric=full"});
  std::printf("  averaged %.3f, full %.3f of beam theory\n", averaged, full);
  EXPECT_GT(averaged, 0.8);
  EXPECT_LT(full, 0.1);
}

// Large strains of a bonded block: within 3 % of the energy that quadratic elements of half the size find (plain linear ones: 59
// % more), and no element comes near to turning inside out.
TEST(Locking, ABondedBlockIsPressed) {
  Rig rig(R"(
mortise: 1
name: pressed
time: {mode: static, steps: 4}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.49, density: 1000}}
bodies:
  block: {type: soft, shape: {box: {size: [20 mm, 20 mm, 10 mm], edge_length: 2.5 mm}}, material: gel, position: [0, 0, 5 mm]}
effects:
  elasticity: {}
  pin:
    - {body: block, where: {side: z_min}}
    - {body: block, where: {side: z_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [0, 0, -3 mm]]}}
)");
  rig.steps(4);
  EXPECT_NEAR(rig.fields().at("elasticity/energy") / 0.036293, 1, 0.03);
  EXPECT_GT(rig.fields().at("elasticity/det_F_min"), 0.3);
}
