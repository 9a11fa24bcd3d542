#pragma once
// Every number by which the solver was tuned, with its reason. What is a promise to the user stands in options.h, what follows from floating
// point beside its formula.
#include "base/types.h"

namespace mortise::solver::tuning {

// ---- when is a step solved? (convergence.h)
inline constexpr double kMotion = 1e-3;       // of the way in this step: far below what the time step itself leaves
inline constexpr double kSize = 1e-6;         // of the body, for one that hardly moves
inline constexpr double kGains = 0.1;         // a residual below the floor of rounding goes on while a digit is gained, to a digit below
inline constexpr double kSupportGap = 1e-13;  // of the scene's length: what rounding leaves of the way of a support
inline constexpr Index kFirstLook = 8;        // iteration at which what touches by now is looked at; then ever more seldom, by powers of two

// ---- curvature (curvature_policy.h)
// What is kept of negative curvature, less where that is not enough, more after a full step. Just beyond the load of a column a 64th less makes the
// Hessian definite, and Newton's method converges nearly as with all of it, while what is unstable grows many times over in an iteration; far beyond
// it half or an eighth of it is still better than none.
inline constexpr double kConcave[] = {1, 63. / 64, 0.875, 0.5, 0.125, 0};

// ---- saddles (saddle_policy.h)
inline constexpr double kStretch = 4;  // in two iterations sixteen times as far: cutting a way that is too long costs an energy per halving
inline constexpr Index kWaits = 40;    // iterations for which rounding may look for a way down: unstable motions grow by a third in each, or more
// where not even an eighth of the negative curvature could be kept, eightfold: from rounding to a micrometre
inline constexpr Index kWaitsConvex = 14;
inline constexpr double kLongest = 1e6;  // beyond it a direction is as little that motion as rounding made it

// ---- linear systems (linear.h)
inline constexpr Index kDirectBlocks = 2000;  // up to here a factor costs next to nothing; beyond it is kept for some iterations,
inline constexpr Index kReuseBlocks = 50000;  // and from here on its memory grows too fast: 45,000 in motion, with friction, take two thirds of the
                                              // CPU time of conjugate gradients, and 1.2 GB instead of 0.8 (benchmarks/linear)
inline constexpr Index kSchwarzRows = 20000;  // up to some ten thousand rows block Jacobi is as quick (benchmarks/linear)
inline constexpr double kLoose = 1e-9;        // of the mean stiffness: far above rounding, far below the softest elastic motion
inline constexpr double kStaleForcing =
    1e-4;                                    // where thin contact layers rule the right-hand side what is soft needs digits too; a solve costs little
inline constexpr Index kStaleMost = 8;       // a factor costs about as much as this many solves with it
inline constexpr Index kWholeStale = 12;     // the same of unsymmetric systems, whose products with new factors take some four of these
inline constexpr Index kWholeMost = 30;      // products of an unsymmetric system: friction takes some five
inline constexpr double kWholeRough = 0.01;  // how closely: 0.03 leaves what is light beside something heavy so rough that H37 with cg takes five
                                             // times the iterations, 0.003 costs conjugate gradients a third more
inline constexpr double kWholeRoughest = 0.1;  // with factors that are kept, where the right-hand side falls slowly: a sixth fewer products in the
                                               // press scene, and as many iterations of Newton's method
inline constexpr double kInner = 0.1;         // conjugate gradients inside of it: 0.3 and 0.03 cost a tenth and a quarter more (scenes/tactile/press)
inline constexpr double kFirstShift = 1e-10;  // of the mean stiffness: picks the shortest step among motions that nothing resists,
inline constexpr double kShiftGrowth = 100;   // grown by this,
inline constexpr double kLargestShift = 1e-2;  // beyond which the matrix is no Hessian of anything
inline constexpr double kRoughest = 0.003;     // the same: rougher directions cost Newton iterations (Eisenstat-Walker)
inline constexpr double kForcingFactor = 0.9;  // gamma of Eisenstat and Walker, choice 2
inline constexpr double kBeyondWanted = 0.1;   // of the residual at which Newton stops: the last system is solved as exactly as that needs
inline constexpr double kSlower = 1.5;         // a preconditioner that has lost more of its speed (iterations per digit) is built anew

// ---- bodies that only contact holds, in statics (loose_hold.h)
inline constexpr double kFar = 100;           // of what the residual over their stiffness explains
inline constexpr double kFlees = 10;          // sizes of the model: nothing that supports are about to grip goes so far
inline constexpr double kGone = 1000;         // sizes too: what has gone so far in statics is on its way for ever
inline constexpr double kFirstHold = 1e-4;    // of their stiffness: seen by motions that meet next to none,
inline constexpr double kHoldGrowth = 10;     // grown by this,
inline constexpr double kLargestHold = 1e-2;  // up to where contact itself converges more slowly for it;
inline constexpr double kHoldFalls = 4;       // slowly back, for what is too loose leads astray again
inline constexpr double kAstray = 0.5;        // of the residual before: a far step that leaves more did not do what it was to do,
inline constexpr double kAway = 2;            // and one that leaves so much more is not taken;
inline constexpr int kRefused = 4;            // so many of them: what is left is a way of hundreds of steps, far along the surface it rests on

// ---- line search (line_search.h)
inline constexpr double kArmijo = 1e-4;           // Nocedal, Wright, 2nd ed., ch. 3.1
inline constexpr int kMostHalvings = 40;          // 1e-12 of a step
inline constexpr double kEnergyRounding = 1e-13;  // of the sum of magnitudes of all energies
inline constexpr double kArc = 1e-3;              // [rad] what turns by less is stretched by less than 5e-7 on a straight way (arcs.h)
inline constexpr double kLongestArc = 1;          // [rad] directions that turn more are those of states far from any solution
inline constexpr int kPushed = 2;                 // halvings after which a support that pushes into new contact is no longer held back,
inline constexpr double kPushing = 0.5;           // as long as its way is so much of the longest in the step: else it is not what raises the energy
inline constexpr int kMostDoubts = 10;            // halvings because of a slope that energy cannot see: beyond, rounding rules the slope too

// ---- scenes beside one that leads (follow.cpp)
inline constexpr int kFollows = 2;  // Newton iterations of a step, on the leader's Jacobian

// ---- lagged quantities (lag_loop.h)
inline constexpr double kLeastRelaxation = 0.1;               // Aitken's share: smaller ones creep
inline constexpr double kLagShare = 0.1;                      // of what refreshing changed: what a round is solved to, but
inline constexpr double kLagFinest = 0.1, kLagCoarsest = 10;  // no finer and no coarser than this, of what is wanted in the end
inline constexpr Index kLagPatience = 5;                      // rounds that come no nearer: time for a shorter step

// ---- when the frozen matrix lacks something (creep_watch.h)
inline constexpr double kFast = 0.1;        // share of the residual that an iteration may leave and still gain a digit,
inline constexpr double kQuadratic = 1e-3;  // or three: what Newton's method does near a solution
inline constexpr Index kPatience = 3;       // slow iterations in a row that count as creeping,
inline constexpr Index kUsual = 20;         // but not before this one: the way into contact takes some, at full steps too
inline constexpr Index kPlainRounds = 2;    // rounds of lagging before the coupled iteration takes over

// ---- friction of the present normal forces (newton.h)
inline constexpr double kCloser = 0.5;       // of the residual: a full step that leaves less is taken whatever energies say,
inline constexpr double kMuchCloser = 0.25;  // where they freeze no more than samples (steps that only halve it may gain energy: H57)

// ---- do iterations get anywhere? (progress_watch.h)
inline constexpr double kProgress = 0.9;     // of the least residual
inline constexpr Index kWholePatience = 12;  // iterations without: then rounds of lagged quantities take over from the whole Jacobian, and the
                                             // coupled iteration is tried again
inline constexpr double kSameForce = 1e-3;   // of the residual: what comes closer by no more would take a thousand iterations,
inline constexpr Index kCircles = 5;         // so often in a row
inline constexpr Index kTurns = 2;           // after so many it goes only
inline constexpr double kBetween = 0.5;      // so far of its way: what is looked for lies between, where forces turn round within nanometres
inline constexpr Index kHopeless = 24;       // where that has failed too: time for a shorter step

// ---- coupled iteration (coupled.h)
inline constexpr double kCoupledForcing = 1e-4;  // the last iteration then ends well below the tolerance
inline constexpr double kRough = 1e-2;           // conjugate gradients as a preconditioner
inline constexpr Index kCoupledIterations = 20, kMostProducts = 30;
inline constexpr Index kGoodProducts = 12;     // with no more of them the factor serves another iteration
inline constexpr int kMonotoneTries = 10;      // shares of a step
inline constexpr double kShort = 0.25;         // a solution is not near where steps are shorter
inline constexpr Index kMostShort = 3;         // so often in a row
inline constexpr double kNearer = 0.5;         // of the residual from which it has failed: nearer it is tried again,
inline constexpr int kMostCoupled = 4;         // so often
inline constexpr double kNaturalShare = 0.25;  // of alpha: how much the natural level has to fall

// ---- the Jacobian at a solution (tangent.h)
inline constexpr double kTangent = 1e-10;              // of the right-hand side: derivatives are then as good as the assembled terms,
inline constexpr double kTangentByDifferences = 1e-6;  // or as differences of forces
inline constexpr double kTangentRough = 1e-4;          // worse is no derivative
inline constexpr double kTangentDifference = 1e-8;     // of the scene's length: a hundredth of the thinnest gaps, a thousand million times rounding
inline constexpr Index kTangentMost = 100;             // products; friction takes some ten

// ---- energy (energy_ledger.h)
inline constexpr double kGainShare = 1e-6;             // of the energy there is: what a step may gain from nowhere
inline constexpr double kFrozenGainShare = 1e-3;       // where something is frozen, what that feeds into motions does not fall with the step
inline constexpr double kSecondOrderGainShare = 1e-3;  // BDF2 may, as its own oscillations of energy are of that size in smooth motion
inline constexpr double kDrivenErr = 0.25;             // of the work of motors and supports in a step: as BDF2 errs where they swing in twelve steps
inline constexpr double kLately = 0.9;  // of the energy that there was a step before: a tenth of it after twenty, what a drive swings to and fro in
// An integrator of second order starts with h/8, h/8, h/4, h/2: each is at most twice the one before, which BDF2 bears, and what the first errs,
// of first order, is a 64th of what it would be.
inline constexpr int kStartHalvings = 3;
inline constexpr double kOwed = 0.02;         // of the energy there is: what a step may gain back of what others lost
inline constexpr double kOwedOn = 0.8;        // of what is owed, in the next step: facets of what rolls come every few steps
inline constexpr double kOwedSecondOn = 0.5;  // the same of what the first step of second order lost, which the next two or three give back
inline constexpr double kGainFalls = 3;       // halving must lower the gain by this; that of backward Euler falls to about a quarter,
inline constexpr double kGainGrows = 4;       // so that a step of twice the length gains this much more: where that is too much it is not tried

// ---- steps (simulation.h)
inline constexpr int kMostFits = 8;  // a pressure that hangs on the stiffness is met within three or four

}  // namespace mortise::solver::tuning
