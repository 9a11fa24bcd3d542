#pragma once
// Every number of this folder that was chosen.

namespace mortise::study::tuning {

// Orders that a method has; what converges faster or slower than these does so by chance. (Linear elements: 1 in stress, 2 in displacement; quadratic
// ones and energies: up to 4; edges of contact and corners take up to a half off.)
inline constexpr double kLeastOrder = 0.5, kMostOrder = 5;

// Roache's factor of safety of an extrapolation from three runs with an observed order (Verification and Validation in Computational Science and
// Engineering, 1998, ch. 5), and the one where no order could be observed.
inline constexpr double kSafety = 1.25, kUnknownOrder = 3;
// Two limits that agree by chance do not make a reference exact: it is no better than this share of what was extrapolated.
inline constexpr double kLeastShare = 0.1;

// How much finer than every ladder a run has to be for the others to be compared with it.
inline constexpr double kOverResolved = 4;

// Errors of knobs cancel where their sum is below this share of the root of their squares, to which errors that have nothing to do with each other
// add up; knobs with less than the second share of it are not named.
inline constexpr double kCancels = 0.7, kCancelsWorthNaming = 0.2;

// A front bends where it passes below the straight line from its first to its last point by this share of the way along it (both axes logarithmic).
inline constexpr double kBend = 0.05;

// Accuracies at which the methods' times are compared.
inline constexpr double kSameErrors[] = {0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001};

// Derivatives: the share by which a parameter is changed to both sides (large against the rounding of forces, 1e-11 in thin contacts, small against
// the gaps that displacements so small are added to); where those to both sides differ by more than the second share there may be none, unless all
// of it is less than the third share of the quantity.
inline constexpr double kHair = 1e-5, kKink = 0.02, kNoDerivative = 1e-3;
// And by more than this share of itself within a hair a quantity jumps (`volumetric: auto` at nu = 0.4).
inline constexpr double kJump = 1e-3;

// Error budgets of scenes that are followed (followed_budget.cpp): the share of a fault that is mended to both sides; errors that differ by more than
// the second share of themselves from side to side are none that first order knows, and beyond the third share of the number they say that much is
// wrong, and not how much.
inline constexpr double kMendedShare = 1e-4, kMendedKink = 0.25, kFirstOrderShare = 0.3;
// A largest value over time that is farther from those a step beside it by more than this share is a peak that steps do not see the top of.
inline constexpr double kPeakShare = 0.02;
// Of the largest elastic energy: bodies that meet or part with more energy of motion strike.
inline constexpr double kStruckShare = 0.01;

// A mesh's part of an error from the jumps of stresses: above this share of the number it was between 0.44 and 0.82 of the true one, below between
// 0.6 and 1.5 (benchmarks/effectivity).
inline constexpr double kCoarseShare = 0.1;
// Of one another, what a mesh makes too stiff and too soft: where the sum of both was left it was up to fifty times less than the error. And of the
// number, both together: less is small whatever hides.
inline constexpr double kHides = 0.4, kHiddenShare = 0.01;
// Of all that holds a body, or of the longest way: what is smaller is what symmetry or balance leave, and shares of it say nothing
// (error_budget.cpp).
inline constexpr double kSmallest = 1e-4;

// Asking for an accuracy (accuracy.cpp). Meshes are refined by the root of two, so that none is much finer than it has to be; times grow as
// sizes^-3.5 (elements ^3, factors and iterations somewhat more), with thinner layers hardly. Layers of contact for pressures are this share of an
// edge: below a twentieth no stiffness is soft enough for the mesh (mortar_contact/README.md, `stiffness`). What converges faster than the order
// below does so by chance, as errors of the layer and of the mesh have two signs: it is then known no better than it changed while sizes were halved.
// What a budget says of a mesh falls at the second order, between 1 and 2 where stresses are singular. Runs are aimed at this share of the goal, and
// what a knob leaves has to be this small a share of it for the knob to be left alone, and the one after it for it never to be looked at again. Runs
// may take longer than foretold by the last factor. No knob is refined by more than this many levels; no accuracy is asked for that is finer or
// coarser than these.
inline constexpr double kMeshRatio = 0.70710678, kMeshDearer = 3.5, kLayerDearer = 0.3, kPressureLayer = 0.05, kTrustedOrder = 2.5, kMeshOrder = 1.5,
                        kAim = 0.8, kAlone = 0.15, kNothing = 1e-6, kForetold = 1.3;
inline constexpr int kMostLevels = 10, kFarthest = 2;  // levels: in all, and at a time
inline constexpr double kFinestGoal = 1e-5, kCoarsestGoal = 0.5;

// Errors below this are rounding: they are drawn and compared as if they were this.
inline constexpr double kRounding = 1e-16;

inline constexpr double kBlind = 0.01;  // of a body's energy: so much in corners between what is held is as good as none (blind.cpp)

}  // namespace mortise::study::tuning
