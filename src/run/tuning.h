#pragma once
// Every number of this folder that was chosen and that a verdict or the time of a run hangs on.
#include <cstddef>

namespace mortise::run::tuning {

// ---- files
inline constexpr double kSaving = 0.05;     // of a run's time, for checkpoints: a kill costs at most the time of twenty of them
inline constexpr double kCommitting = 0.1;  // [s] between commits of frames, for each run of a process: one takes some 5 ms

// ---- what a scene asks for
inline constexpr double kOnBody = 1e-3;     // of a body's diagonal: a place so near is on it (reported.cpp)
inline constexpr double kRounding = 1e-12;  // of a time: it is a sum of steps (reported.cpp)

// ---- warnings: beyond what solids, steps and contact layers are in practice; most often a unit is missing
inline constexpr double kSoftest = 100, kStiffest = 2e12;         // Young's modulus [Pa]: the softest tissue, twice diamond
inline constexpr double kLightest = 10, kHeaviest = 3e4;          // density [kg/m^3]: foams, and what is given in g/cm^3; above osmium
inline constexpr double kLongestStep = 0.5;                       // [s]
inline constexpr double kMillimetres = 9810, kNearlyThat = 5e-4;  // free fall on the Earth in mm/s^2, to some places
inline constexpr double kLargestMesh = 10;                        // of a file [m]
inline constexpr double kRoughest = 10;                           // coefficient of friction
inline constexpr double kStiffestLayer = 1e15;                    // of contact [Pa]
inline constexpr double kMostMass = 1e6;                          // of a body [kg]
inline constexpr double kFarthest = 1000;                         // of a body from the origin [m]
inline constexpr double kLeastCovered = 0.1;                      // of a sensor's grid: what is so large was meant in millimetres
inline constexpr double kLeastFelt = 0.1;                         // by a sensor, of the largest force on its body (sensor_reach.h)
inline constexpr double kCoarsest = 10;                           // edge_length over the size of a body
inline constexpr double kThickest = 0.1;                          // d_hat over the size of a body
inline constexpr int kFewBends = 8;        // of a target: phases of a scene have fewer, a track that was sampled more (corners.cpp)
inline constexpr double kBend = 0.01;      // of its fastest speed
inline constexpr double kNearlyAll = 0.8;  // of the memory there is: other programs want some, and the estimate is one (memory.cpp)

// ---- environments
inline constexpr std::size_t kOddEpisodes = 3;  // of an environment, all of one step: its reset is hardly meant
inline constexpr long kTogether = 16;           // in a model on a CPU; of 256, a step costs each a fifth more (benchmarks/environments)

}  // namespace mortise::run::tuning
