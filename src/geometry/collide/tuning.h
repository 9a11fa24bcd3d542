#pragma once
// Every number of search, distances and continuous collision detection that was chosen, with its reason.
#include "device/device.h"

namespace mortise::geometry::tuning {

// ---- search (broadphase.h, bvh.h, pair_search.h)
inline constexpr double kSurplus = 3;           // of the way of the farthest point: the next question comes from its end, and ways get shorter
inline constexpr double kLargestSurplus = 0.1;  // of the mean edge of the finest body: more finds many neighbours that never meet
inline constexpr double kCoordinate = 1e-14;    // of a coordinate: what rounding moves a point by
inline constexpr int kReorderEvery = 16;        // updates: bodies move little between them
inline constexpr Index kNoted = 16;             // pairs that a query may note while they are counted; one with more walks the tree again
// Threads that walk a tree for one query, a power of two. A GPU has more of them than a small scene has queries, and waits for the slowest.
inline constexpr Index kMostWalkers = device::kHostThreads ? 1 : 8;
inline constexpr Index kThreads = 1 << 18;  // that are at work at once: 2,048 on each of some 130 multiprocessors

// Of long ways those are shortened on which more pairs lie than this, and than this for each point and edge: some ten times what lies within an edge
// of everything at rest.
inline constexpr double kFewPairs = 100000, kPairsEach = 100;
inline constexpr int kShortenings = 12;  // at most: the first makes a way as long as the scene, each of the others halves it

// ---- distances (distance.h, near_pairs.h)
inline constexpr double kParallel = 1e-16;  // sin^2 of the angle between directions below which their plane carries no information in doubles
inline constexpr double kApart = 1e-12;     // of a distance: far above its rounding, far below what any decision hangs on

// ---- continuous collision detection (ccd.h)
inline constexpr int kAdvances = 128;        // of first_impact; subdivision decides what is left
inline constexpr int kStepAdvances = 512;    // of step_limit: of random motions one in 5,000 takes more than 64
inline constexpr int kCells = 1000000;       // of subdivision, of pairs that are apart
inline constexpr int kCellsInContact = 512;  // where it mostly confirms what is known: enough for pairs that miss each other by rounding
inline constexpr int kCellsWaiting = 160;    // depth of its stack: three coordinates halved down to kNarrowest
inline constexpr double kNarrowest = 1e-14;  // of a coordinate of a cell
inline constexpr double kResolution = 1e-6;  // of the size of the pair: contacts closer than that may be reported although they do not happen
inline constexpr double kUsable = 100;       // parts of what a step may use of a distance: step_limit stops when one is left

}  // namespace mortise::geometry::tuning
