// When a step counts as solved, on figures by hand.
#include "solver/convergence.h"

#include <gtest/gtest.h>

#include "solver/rows.h"
#include "toy.h"

using namespace mortise;
using namespace mortise::solver;

namespace {

// One free body of four nodes, on which forces of 1 N act; a Newton step from `before` has led to where it is judged.
struct Judged {
  model::Model model{toy::boxes(1)};
  Options options;
  Convergence convergence{model, options};
  Residual before, now;
  double step = 1e-3;                        // its length [m]
  static constexpr double kRelative = 1e-6;  // what is asked for
  explicit Judged(double stiffness = 0) {    // of the matrix [N/m]: with it, rounding
    convergence.begin_step();
    before = now = convergence.begin();
    for (Residual* r : {&before, &now}) r->scale[0] = r->load[0] = 1, r->way[0] = 0.01;
    before.force[0] = 1, now.force[0] = 1e-7;
    if (stiffness == 0) return;
    Rows rows;
    rows.number(model, false);
    convergence.set_rows(rows.of_block_host);
    linalg::BlockMatrix A;
    std::vector<std::uint64_t> keys;
    for (Index r = 0; r < rows.count(); ++r) keys.push_back(linalg::block_key(r, r, rows.count()));
    linalg::set_pattern(device::Buffer<std::uint64_t>(keys), rows.count(), A);
    A.value.upload(std::vector<Mat3>(4, stiffness * Mat3::Identity()));
    device::Fetch fetch;
    convergence.see_matrix(A, model.q.view(), rows.block.view(), {1}, fetch);
    fetch.now();
  }
  bool solved() {
    device::Fetch fetch;
    const device::Buffer<Vec3> dq(std::vector<Vec3>(4, Vec3(step, 0, 0)));
    convergence.see_step(dq.view(), before, {1}, fetch);
    fetch.now();
    return convergence.solved(now, 0, kRelative);
  }
};

}  // namespace

TEST(Convergence, ForcesOnABodyBalanceOneByOneAndInAll) {
  EXPECT_TRUE(Judged().solved());
  Judged one;
  one.now.force[0] = 1e-5;
  EXPECT_FALSE(one.solved());
  Judged all;
  all.now.net[1][0] = 1e-5;
  EXPECT_FALSE(all.solved()) << "nothing supports it, so what is left carries it away";
}

TEST(Convergence, ABodyThatWouldGoOnMovingIsNotSolved) {
  Judged j;
  j.step = 1000;  // and the next a ten millionth of it: 0.1 mm where it went 10 mm
  EXPECT_FALSE(j.solved());
  j.step = 50;
  EXPECT_TRUE(j.solved());
}

// 1e12 N/m at 1 m: rounding may make 2.5 mN.
TEST(Convergence, BelowRoundingItGoesOnWhileDigitsAreGained) {
  Judged j(1e12);
  j.now.force[0] = 1e-3;
  EXPECT_FALSE(j.solved()) << "from 1 N";
  j.now.force[0] = 1e-4;
  EXPECT_TRUE(j.solved()) << "far below, there is nothing to gain";
  j.before.force[0] = 1e-3;
  EXPECT_TRUE(j.solved()) << "what it came from may have been rounding";
  j.before.force[0] = 1;
  j.now.force[0] = 0.1 * j.before.force[0];
  EXPECT_FALSE(j.solved()) << "more than rounding";
}

TEST(Convergence, AStateThatNoStepLedToIsSolvedOnlyWithoutAnyForce) {
  Judged j;
  EXPECT_FALSE(j.convergence.solved(j.now, 0, Judged::kRelative));
  j.now.force[0] = 0;
  EXPECT_TRUE(j.convergence.solved(j.now, 0, Judged::kRelative));
}
