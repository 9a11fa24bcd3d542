#pragma once
// Numbers of motors and what they aim at, with their reasons.

namespace mortise::effects::drive::tuning {

inline constexpr double kRamp = 0.1;         // of `velocity`: its last tenth, over which the torque goes; a step's rate has to find its place there
inline constexpr double kCreep = 1e-3;       // [rad/s]: rate at which dry friction is fully there; what it holds gives way by less in a step,
inline constexpr double kCreepSlide = 1e-4;  // of slides [m/s]
inline constexpr double kSame = 1e-6;        // [rad, m]: a given target that begins beside where the joint stands by no more is where it stands
inline constexpr double kMostTurn = 0.126;   // [rad] in a step: an arc of it about the middle of a body leaves its chord by 0.2 % of the body

// Legs of gaits (gait.h):
inline constexpr double kParallel = 1e-3;  // [rad] between the hinges of a leg: what robots' files round
inline constexpr double kAcross = 0.5;     // share of `forward` and `up` along the hinges: 30 degrees, beyond which steps would go sideways
inline constexpr double kStraight = 0.02;  // [rad] of bend: which way a straighter knee is to bend is not known
inline constexpr int kSamples = 200;       // of a cycle, at which its path is checked: a hundredth of the stride, or less, apart

}  // namespace mortise::effects::drive::tuning
