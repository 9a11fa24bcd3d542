// Forces and matrices that ties take back to what is free: T^T g and T^T K T, against differences of energies and forces along q = T z + h.
#include <gtest/gtest.h>

#include <random>

#include "effects/finite_difference.h"
#include "effects/problem.h"
#include "solver/system.h"
#include "toy.h"

using namespace mortise;
using namespace mortise::solver;
using fd::Matrix;
using fd::Vector;

namespace make = mortise::testing;

namespace {

Params entry(std::initializer_list<std::pair<std::string, Params>> keys) {
  Params p = fd::table(keys);
  if (!p.has("contact")) p.set("contact", Params::make_flag(false));
  return p;
}
Params text(const std::string& s) { return Params::make_text(s); }

// Two sheared balls, the first hinged to the world about a skew axis, the second to the first by `second`, and a soft box of which a side is bonded
// to the second.
model::ModelInput arm() {
  model::ModelInput in;
  in.scene = Params::make_table();
  geometry::TetMesh ball = geometry::sphere(0.5, 0.5);
  for (Vec3& x : ball.points) x += Vec3(0.4, 0.2, 0) * x[2];
  const Params steel = make::material("linear", 1e9, 0.3, 2000);
  in.bodies.push_back(make::stiff_body("upper", ball, steel, {0, 0, 0}));
  in.bodies.push_back(make::stiff_body("lower", ball, steel, {1, 0.3, -1}));
  in.bodies.push_back(make::soft_body("pad", geometry::box({1, 1, 1}, 0.5), make::material("neo_hookean", 1e5, 0.4, 1000), {1.2, 0.3, -2}));
  return in;
}

struct Arm {
  model::Model model;
  EffectList effects;
  Options options = toy::options();
  Clock clock;

  explicit Arm(const std::string& second) : model(arm()) {
    Params joints = Params::make_list(), bonds = Params::make_list();
    joints.push(entry({{"type", text("revolute")}, {"body", text("upper")}, {"at", make::vec({0.1, 0, 0.7})}, {"axis", make::vec({1, -2, 0.5})}}));
    Params to = entry({{"type", text(second)}, {"body", text("lower")}, {"to", text("upper")}, {"at", make::vec({0.5, 0.1, -0.5})}});
    if (second == "revolute") to.set("axis", make::vec({0.2, 1, 0.1}));
    joints.push(to);
    bonds.push(entry({{"body", text("pad")}, {"to", text("lower")}, {"where", make::where_side("z_max")}}));
    add("joint", joints);
    add("bond", bonds);
    add("inertia", fd::table({{"integrator", text("backward_euler")}}));
    add("gravity", fd::table({{"acceleration", make::vec({1, 2, -9})}}));
    add("elasticity", Params::make_table());
    add("affine_body", fd::table({{"stiffness", Params::make_number(1e6)}}));
  }
  void add(const std::string& name, const Params& params) { effects.push_back(effects::find_kind(name)->make(params, model)); }
};

// All blocks of the free ones z.
device::Buffer<Vec3> positions(const Arm& arm, const Rows& rows, const Vector& z) {
  std::vector<Vec3> q = arm.model.q.download();
  for (Index r = 0; r < rows.count(); ++r) q[rows.of_row[r]] = z.segment<3>(3 * r);
  device::Buffer<Vec3> out(q);
  arm.model.ties.place(out.view());
  return out;
}

Vector of_rows(const Rows& rows, const std::vector<Vec3>& v) {
  Vector out(3 * rows.count());
  for (Index r = 0; r < rows.count(); ++r) out.segment<3>(3 * r) = v[rows.of_row[r]];
  return out;
}

void check(const std::string& second, Index free_blocks) {
  Arm arm(second);
  System system(arm.model, arm.effects, arm.options, arm.clock);
  for (const auto& effect : arm.effects) effect->begin_step({0, 0.1, 0, false});
  system.begin_solve();
  const Rows& rows = system.rows;
  ASSERT_EQ(rows.count(), free_blocks) << second;
  Vector z = of_rows(rows, arm.model.q.download());
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> u(-0.05, 0.05);
  for (double& x : z) x += u(rng);

  Linearised at = system.potential.linearised();
  const auto energy = [&](const Vector& x) {
    const device::Buffer<Vec3> q = positions(arm, rows, x);
    system.potential.linearise(q.view(), {}, at);
    Energies of;
    device::Fetch fetch;
    system.potential.energies(q.view(), at, of, fetch);
    fetch.now();
    double sum = 0;
    for (const auto& part : of) sum += part[0];
    return sum;
  };
  const auto force = [&](const Vector& x) {
    const device::Buffer<Vec3> q = positions(arm, rows, x);
    system.potential.linearise(q.view(), {}, at);
    return of_rows(rows, at.gradient.download());
  };
  EXPECT_LT(fd::relative_error(force(z), fd::difference_gradient(energy, z, 1e-4)), 1e-7) << second;

  const device::Buffer<Vec3> q = positions(arm, rows, z);
  system.potential.linearise(q.view(), {true, {true, 1}}, at);
  linalg::BlockMatrix A;
  device::Fetch fetch;
  system.matrix(at, q.view(), {1}, A, fetch, fetch);
  fetch.now();
  Matrix H = Matrix::Zero(z.size(), z.size());
  const auto row = A.row.download(), col = A.col.download();
  const auto value = A.value.download();
  for (std::size_t k = 0; k < value.size(); ++k) {
    H.block<3, 3>(3 * row[k], 3 * col[k]) = value[k];
    H.block<3, 3>(3 * col[k], 3 * row[k]) = value[k].transpose();
  }
  EXPECT_LT(fd::relative_error(H, fd::difference_jacobian(force, z, 1e-4)), 1e-6) << second;

  // The product with the whole Hessian is taken back too.
  const device::Buffer<Vec3> zero(std::vector<Vec3>(arm.model.blocks, Vec3::Zero()));
  device::Buffer<Vec3> way, Hd;
  const Vector d = Vector::Random(z.size());
  const device::Buffer<Vec3> x(fd::blocks_of(d));
  system.to_blocks(x.view(), zero.view(), {1}, way);
  system.potential.product(at, std::as_const(way).view(), Hd);
  EXPECT_LT(fd::relative_error(H * d, of_rows(rows, Hd.download())), 1e-12) << second;
}

}  // namespace

// 27 nodes of the box, nine of them bonded.
TEST(Ties, TakeForcesAndMatricesToWhatIsFree) {
  check("revolute", 2 + 2 + 18);
  check("spherical", 2 + 3 + 18);
  check("fixed", 2 + 18);
}
