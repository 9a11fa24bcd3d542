#pragma once
// What robots' files do not say, and an import has to choose.

namespace mortise::importers {

inline constexpr double kDensity = 1000;        // of links without mass [kg/m^3]: water, as most simulators take
inline constexpr double kRoundCells = 0.6;      // edges of cylinders over their radius: sixteen corners around
inline constexpr double kBallCells = 0.5;       // of balls: sixteen around as well
inline constexpr double kLeastMass = 1e-3;      // of a body [kg]: placeholders of 1e-6 kg make matrices that no digits are left for
inline constexpr double kStandInRadius = 0.01;  // of the ball in the place of a link without shape [m]
inline constexpr double kShortestBar = 0.04;  // in the place of a link's shape, to the joints that hang on it [m]: shorter, and a ball shows as much
inline constexpr double kBarRadius = 0.12;    // over its length,
inline constexpr double kBarRadii[2] = {0.003, 0.05};       // and between these [m]
inline constexpr double kBearingRadius = 0.002;             // of the one between two joints of a body [m]: inside of nearly all that it could be in
inline constexpr double kThinnest = 1e-3;                   // least share of int rho X X^T along an axis that a mended tensor has
inline constexpr double kSameLimit = 1e-6;                  // of its range: a joint that mimics another stands at its limit, not beyond it
inline constexpr double kFromLimit = 2;                     // a joint stands at least so many ranges of its stop from a limit
inline constexpr double kStopRange[2] = {0.0174533, 5e-4};  // where stops begin, of hinges [rad] and slides [m] (effects/joint/README.md)
inline constexpr double kFullEffort[2] = {0.25, 5e-3};      // a motor gives all that it can where it misses its target by this [rad, m]
inline constexpr double kSettling = 0.05;                   // kd / kp [s]: of the order of the time a limb takes to swing
inline constexpr double kHold = 10;                         // without an effort: so many times the weight of all, at the lever of a tenth of a metre
inline constexpr double kSwayRate = 1;                      // [Hz] of --sway,
inline constexpr double kSwaySlide = 0.1;                   // of slides for every radian of hinges [m],
inline constexpr double kSwayRoom = 0.8;                    // and at most this share of the way to the nearer limit: motors overshoot
inline constexpr double kOverlap = 1e-3;                    // bodies nearer than this as they stand pass through each other [m]
inline constexpr double kRubber = 1e6;                      // Young's modulus of a pad [Pa]: Shore A 28
inline constexpr double kRubberPoisson = 0.45;
inline constexpr double kPadDensity[3] = {200, 5000, 1100};  // what a pad's mass and volume may make, and what stands for all else [kg/m^3]
inline constexpr double kAcross = 0.5;                       // least that hinges of legs lean against x and z, as cosine: 30 degrees
inline constexpr double kParallelLeg = 1e-3;                 // [rad] between them: what files round
inline constexpr double kBent = 0.02;                        // [rad] of a knee: which way a straighter one is to bend is not known
// Steps of legs, where nothing is said: those of Go2's usual trot (2 Hz, 0.10 m, 0.06 m at hips 0.27 m high), times roots and ratios of heights.
inline constexpr double kPeriod = 3;                        // of the root of height over gravity
inline constexpr double kStride = 0.37, kClearance = 0.22;  // of the height
inline constexpr double kTrotDuty = 0.55, kWalkDuty = 0.8;  // a little, or all but one leg, longer than half on the ground
inline constexpr double kGaitBegin = 0.3, kGaitRamp = 0.5;  // [s]: it has come down to the floor by then; steps grow over a cycle
inline constexpr double kGaitCycles = 4;                    // that the written scene has time for
inline constexpr double kPadCells = 6;                      // along the side of a cube as large as the box around a pad

}  // namespace mortise::importers
