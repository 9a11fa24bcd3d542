#pragma once
// Every number of this folder that was chosen or measured.
#include <cstdint>

namespace mortise::cost::tuning {

// CPU time of one Newton iteration [s] on the machine of kReferenceSeconds, fitted to the committed scenes that run in a minute (benchmarks/plan):
// half of them within 1.26, nine of ten within 2.4.
inline constexpr double kPerIteration = 1.3e-4, kPerTet = 4.1e-6, kPerQuadraticTet = 3.9e-5, kPerTriangle = 1.05e-6;
inline constexpr double kPerFactor = 5e-9;         // and (blocks of a body)^2: factors; half of the iterations do with an older one where they may
inline constexpr double kPerIterated = 8e-6;       // and block: conjugate gradients
inline constexpr double kReferenceSeconds = 0.35;  // of the small scene there (AMD EPYC, one thread, quiet)

// Newton iterations of a step where nothing better is known: medians of the same scenes; a third of them are off by more than kSpread.
inline constexpr double kIterations = 3.5, kIterationsStatic = 9, kIterationsFree = 1.5, kIterationsDriven = 9, kSpread = 3;

// The first steps of the scene itself are taken for this long; iterations that the model calls longer than the second are not begun.
inline constexpr double kTrial = 2, kLongestIteration = 1;

// The scout: its time, or its share of what is foretold where that is more; edge lengths, times the scene's.
inline constexpr double kScout = 4, kScoutShare = 0.05, kScoutEdges[] = {1.5, 2, 3, 4};
// Iterations with contact take longer than those before it by no more than this, and what a scout foretells is expected within kScouted.
inline constexpr double kMostGrown = 3, kScouted = 2;

// The same steps again differ by this (caches, other work on the machine, another number of threads).
inline constexpr double kAgain = 1.25;
// As much as two runs of one kind differ by in iterations per step.
inline constexpr double kSameKind = 2;

inline constexpr std::uintmax_t kMostKept = 256 << 10;  // bytes of times.jsonl: some thousand runs

}  // namespace mortise::cost::tuning
