// The strategies of Newton's loop that need no equations: curvature, creeping, progress, the energy guard, the table of environments.
#include <gtest/gtest.h>

#include "solver/creep_watch.h"
#include "solver/curvature_policy.h"
#include "solver/energy_ledger.h"
#include "solver/loose_hold.h"
#include "solver/moving_policy.h"
#include "solver/progress_watch.h"
#include "solver/saddle_policy.h"

using namespace mortise;
using namespace mortise::solver;

TEST(CurvaturePolicy, ConvexUntilAFullStepThenExactAndSoftenedWhereIndefinite) {
  CurvaturePolicy p(1);
  p.begin_step();
  p.choose(0, 0);  // before the first step
  EXPECT_EQ(p.concavity(0), 0);
  p.choose(0, 1);
  EXPECT_EQ(p.concavity(0), 1);
  p.soften(0);
  EXPECT_EQ(p.concavity(0), 63. / 64);
  p.soften(0);
  EXPECT_EQ(p.concavity(0), 0.875);
  p.choose(0, 1);
  EXPECT_EQ(p.concavity(0), 63. / 64);
  p.choose(0, 1);
  EXPECT_EQ(p.concavity(0), 1);
  p.soften(0);
  p.choose(0, 0.5);  // a cut step
  EXPECT_EQ(p.concavity(0), 0);
  p.choose(0, 1);
  for (int i = 0; i < 8; ++i) p.soften(0);
  EXPECT_EQ(p.concavity(0), 0) << "convex";
}

TEST(CurvaturePolicy, EveryEnvironmentHasItsOwn) {
  CurvaturePolicy p(3);
  p.choose(0, 1), p.choose(1, 0.5), p.choose(2, 1);
  p.soften(2);
  EXPECT_EQ(p.concavity(0), 1);
  EXPECT_EQ(p.concavity(1), 0);
  EXPECT_EQ(p.concavity(2), 63. / 64);
  const effects::Curvature c = p.wanted();
  std::vector<double> seen(3);
  device::copy_out(seen.data(), c.of_env.p, 3 * sizeof(double));
  EXPECT_EQ(seen, (std::vector<double>{1, 0, 63. / 64}));
}

TEST(CreepWatch, SeesThreeSlowIterationsButNotInTheFirstTwenty) {
  CreepWatch w(2);
  w.look(0, 0, 0, 0, 0), w.look(1, 0, 0, 0, 0);
  for (Index it = 1; it < 20; ++it) EXPECT_FALSE(w.look(0, it, 0.9, 100, 1).creeps) << it;
  EXPECT_TRUE(w.look(0, 20, 0.9, 100, 1).creeps);
  EXPECT_FALSE(w.look(0, 21, 0.01, 100, 1).creeps) << "a fast one starts the count anew";
  EXPECT_FALSE(w.look(1, 20, 0.9, 100, 1).creeps) << "of another environment";
}

TEST(CreepWatch, SeesLinearConvergenceWhileDigitsAreMissing) {
  CreepWatch w(1);
  w.look(0, 0, 0, 0, 0);
  EXPECT_FALSE(w.look(0, 1, 0.01, 1e4, 1).linear) << "one iteration is no sequence";
  EXPECT_TRUE(w.look(0, 2, 0.01, 1e4, 1).linear);
  EXPECT_FALSE(w.look(0, 3, 0.01, 50, 1).linear) << "one more such iteration is enough";
  EXPECT_FALSE(w.look(0, 4, 1e-5, 1e9, 1).linear) << "quadratic";
  EXPECT_FALSE(w.look(0, 5, 0.01, 1e4, 0.5).linear) << "a cut step says nothing";
}

// From the first full step that left more than a tenth of the residual on, until a step is cut.
TEST(MovingPolicy, BeginsWhereFullStepsConvergeSlowly) {
  MovingPolicy p(2);
  p.begin(0), p.begin(1);
  EXPECT_FALSE(p.choose(0, 0)) << "nothing is known";
  p.see(0, 1);
  EXPECT_FALSE(p.choose(0, 1));
  p.see(0, 0.05);
  EXPECT_FALSE(p.choose(0, 1)) << "a digit was gained";
  p.see(0, 0.02);
  EXPECT_FALSE(p.choose(0, 0.5)) << "cut";
  EXPECT_TRUE(p.choose(0, 1));
  p.see(0, 1e-9);
  EXPECT_TRUE(p.choose(0, 1)) << "it gains digits because of it";
  EXPECT_FALSE(p.choose(0, 0.5));
  EXPECT_FALSE(p.choose(0, 1));
  EXPECT_FALSE(p.choose(1, 1)) << "another environment";
  p.see(0, 1);
  EXPECT_TRUE(p.choose(0, 1));
  p.begin(0);
  EXPECT_FALSE(p.choose(0, 1));
}

// The residual of the iterate before the last, five times in a row, and no lower energy: nothing is gained by more.
TEST(ProgressWatch, SeesACircleOfTwo) {
  ProgressWatch w(1);
  const auto look = [&](Index i, double force, double energy) { return w.look(0, i, force, energy, true); };
  look(0, 100, 0), look(1, 1, -1);
  Index i = 2;
  for (; i < 8; ++i) EXPECT_FALSE(look(i, i % 2 ? 1.1 : 1.2, -1).circles) << i;
  const ProgressWatch::Sight circle = look(i, 1.2, -1);
  EXPECT_TRUE(circle.circles);
  EXPECT_GE(circle.idle, tuning::kHopeless);
  EXPECT_FALSE(look(++i, 1.1, -2).circles) << "a lower energy";
  EXPECT_FALSE(look(++i, 1.2, -2).circles);
}

// Ways grow while residuals do, with part of the negative curvature, from one iteration to the next but one; a cut one ends that.
TEST(SaddlePolicy, LongerWaysWhileItLeaves) {
  SaddlePolicy p(2);
  p.begin(0), p.begin(1);
  EXPECT_EQ(p.choose(0, 1, 0.25, 8), 1);
  EXPECT_EQ(p.choose(0, 1, 0.5, 4), 1);
  EXPECT_EQ(p.choose(0, 1, 0.25, 5), 1) << "less than before that";
  EXPECT_EQ(p.choose(0, 1, 0.5, 4.5), 4);
  EXPECT_EQ(p.choose(0, 1, 0.25, 9), 16);
  EXPECT_EQ(p.choose(1, 1, 0.25, 9), 1) << "another environment";
  EXPECT_EQ(p.choose(0, 0.5, 0.25, 20), 1) << "cut";
  EXPECT_EQ(p.choose(0, 1, 0, 30), 1) << "nothing but a convex matrix was tried";
  EXPECT_EQ(p.choose(0, 1, 1, 35), 1) << "the Hessian is definite";
  EXPECT_EQ(p.choose(0, 1, 0, 40), 4);
  for (int i = 0; i < 40; ++i) EXPECT_LE(p.choose(0, 1, 0.5, 50 + i), tuning::kLongest);
}

TEST(SaddlePolicy, WaitsForRoundingWhereTheHessianIsIndefinite) {
  SaddlePolicy p(1);
  p.begin(0);
  EXPECT_FALSE(p.waits(0, 1));
  EXPECT_TRUE(p.waits(0, 0)) << "nothing is known of it";
  int waited = 1;
  while (p.waits(0, 0.25) && waited < 1000) ++waited;
  EXPECT_EQ(waited, tuning::kWaits);
}

TEST(ProgressWatch, ForcesAndEnergiesCountEachByItself) {
  ProgressWatch w(2);
  EXPECT_EQ(w.look(0, 0, 100, 0, true).idle, 0);
  EXPECT_EQ(w.look(0, 1, 95, -1, true).idle, 0) << "the first energy";
  EXPECT_EQ(w.look(0, 2, 95, -1, true).idle, 1) << "a residual must fall by a tenth";
  EXPECT_EQ(w.look(0, 3, 80, 5, true).idle, 0);
  EXPECT_EQ(w.look(0, 4, 90, 0, true).idle, 1);
  ProgressWatch::Sight s = w.look(0, 5, 1e9, -2, true);
  EXPECT_TRUE(s.falls);
  EXPECT_EQ(s.idle, 0) << "forces may rise where energies fall";
  s = w.look(0, 6, 1e9, -3, false);
  EXPECT_FALSE(s.falls) << "where energies say nothing";
  EXPECT_EQ(s.idle, 1);
  EXPECT_FALSE(w.look(0, 7, 1e9, -2.5, true).falls) << "the lowest is remembered all the same";
  w.look(1, 0, 1, 0, true);
  EXPECT_EQ(w.look(1, 1, 1, 0, false).idle, 1) << "of another environment";
  EXPECT_EQ(w.look(0, 0, 1e12, 0, true).idle, 0) << "iterations begin anew";
  EXPECT_TRUE(w.look(0, 1, 1e12, 100, true).falls);
  EXPECT_EQ(w.look(1, 0, 1, 0, true).idle, 0);
  EXPECT_FALSE(w.look(1, 1, 1, INFINITY, true).falls) << "supports moved";
  EXPECT_TRUE(w.look(1, 2, 1, 7, true).falls) << "the first energy after that";
}

TEST(EnergyGuard, HalvesWhileThatHelps) {
  EnergyGuard g;
  EXPECT_FALSE(g.wants_halving({1e-7, 1, 0}, 1e-6)) << "little";
  EXPECT_TRUE(g.wants_halving({1e-2, 1, 0}, 1e-6));
  EXPECT_TRUE(g.wants_halving({1e-2 / 4, 1, 0}, 1e-6)) << "fell as it should";
  EXPECT_FALSE(g.wants_halving({1e-2 / 5, 1, 0}, 1e-6)) << "did not";
  EXPECT_FALSE(g.wants_halving({1, 1, 0}, 1e-6)) << "no more of this step";
  g = {};
  EXPECT_FALSE(g.wants_halving({.gain = 1e-2, .there = 1, .owed = 1e-2}, 1e-6)) << "was lost before";
  EXPECT_TRUE(g.wants_halving({.gain = 1e-2, .there = 1, .owed = 5e-3}, 1e-6));
}

TEST(EnvTable, RowsChangeAlone) {
  EnvTable t(3);
  t.fail(1, "why");
  EXPECT_EQ(t.mask(EnvState::running), (EnvMask{1, 0, 1}));
  t.change(EnvState::running, EnvState::settled);
  EXPECT_TRUE(t.is(1, EnvState::failed));
  EXPECT_EQ(t[1].reason, "why");
  EXPECT_FALSE(t.any(EnvState::running));
}

TEST(LooseHold, TightensAfterFarStepsThatLeadNowhereAndLoosensWhereItHoldsBack) {
  LooseHold hold(2);
  hold.begin_solve();
  hold.set_stiffness(0, 100, 1e4), hold.set_stiffness(1, 100, 1e4);
  EXPECT_EQ(hold.scale(0), 0);
  EXPECT_FALSE(hold.far(0, {1, 0}, 1e-4)) << "1 N over 10 kN/m explain 0.1 mm";
  EXPECT_TRUE(hold.far(0, {1, 0}, 0.011));
  hold.look(0, {1, 0}, {0.9, 0}, 1, 1e-4);
  EXPECT_EQ(hold.scale(0), 0) << "a short step that gains little is contact's own affair";
  hold.look(0, {1, 0}, {0.9, 0}, 0.5, 1);
  EXPECT_EQ(hold.scale(0), 0) << "a cut step says nothing";
  hold.look(0, {1, 0}, {0.1, 0}, 1, 1);
  EXPECT_EQ(hold.scale(0), 0) << "a far step that does what it should";
  hold.look(0, {1, 0}, {0.9, 0}, 1, 1);
  EXPECT_EQ(hold.scale(0), tuning::kFirstHold);
  hold.tighten(0);
  EXPECT_EQ(hold.scale(0), tuning::kFirstHold * tuning::kHoldGrowth);
  hold.look(0, {1, 0}, {0.5, 0}, 1, 0.4);  // 4 N were held back
  EXPECT_EQ(hold.scale(0), tuning::kFirstHold * tuning::kHoldGrowth / tuning::kHoldFalls);
  for (int i = 0; i < 9; ++i) hold.tighten(0);
  EXPECT_EQ(hold.scale(0), tuning::kLargestHold);
  EXPECT_EQ(hold.scale(1), 0) << "of another environment";
}

TEST(LooseHold, LetsABodyOfManyNodesFall) {
  LooseHold hold(1);
  hold.begin_solve();
  hold.set_stiffness(0, 10000, 1e4);
  EXPECT_TRUE(hold.far(0, {1e-4, 0.1}, 1e-3)) << "a force on one node";
  EXPECT_FALSE(hold.far(0, {1e-4, 100}, 1e-3)) << "and on many, 100 N in all";
  hold.tighten(0);
  hold.look(0, {1, 100}, {0.1, 300}, 1, 1e-4);
  EXPECT_EQ(hold.scale(0), tuning::kFirstHold);
  hold.look(0, {1, 100}, {0.1, 1}, 1, 1e-4);  // 1e-4 N on every node, 1 N on all
  EXPECT_EQ(hold.scale(0), tuning::kFirstHold / tuning::kHoldFalls);
}

TEST(LooseHold, RefusesWhatRaisesTheResidualUntilItIsTight) {
  LooseHold hold(1);
  hold.begin_solve();
  EXPECT_TRUE(hold.astray(0, 1, 2.1));
  EXPECT_FALSE(hold.astray(0, 1, 1.9));
  for (int i = 0; i < 9; ++i) hold.tighten(0);
  EXPECT_FALSE(hold.astray(0, 1, 100)) << "else Newton would stand still";
}
