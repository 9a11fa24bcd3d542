#pragma once
// Every number of mortar_contact that was chosen, with its reason. What follows from floating point or from a formula stands beside it.

namespace mortise::effects::mortar::tuning {

// ---- which master faces count for a slave (consistent.h, tapered.h): c = -n_s . n_m, 1 where the faces are parallel. C1 from none to all
// consistent: none beyond 70 degrees, all within 49. A gap along the slave's normal says nothing about a surface that slides past at an angle.
inline constexpr double kFaceNone = 0.35, kFaceFade = 0.3;
// tapered: none beyond 87 degrees, all within 81: the published form counts whatever faces the slave; a jump would stop Newton's method.
inline constexpr double kTaperedNone = 0.05, kTaperedFade = 0.1;

// ---- edges and points of consistent weights (consistent.h)
inline constexpr double kGate = 0.015192246987791981;  // 1 - cos 10 deg: a face this near to parallel is seen by its own samples
inline constexpr double kSharp = 0.13397459621556135;  // 1 - cos 30 deg: the facets of a round body are bent by less, ridges by more
inline constexpr double kFarSide = 0.2;                // -n . mean normal: edges and points that look away fade out over 12 degrees
inline constexpr double kBent = 1.523048436087608e-4;  // 1 - cos 1 deg: below it two slave triangles have one normal for what slides over them
inline constexpr double kStrip = 1e-10;                // of the altitude: what lies this near to a side lies on it

// ---- edges and points of tapered weights (tapered.h)
inline constexpr double kOnSide = 1e-10;    // barycentric; a master vertex this near to a slave edge lies on it
inline constexpr double kGoesOn = 0.5;      // cos 60 deg: triangles that are bent more against each other do not share what lies on their common side
inline constexpr double kPointShare = 0.1;  // of e^2 sum A: what tapers of faces and edges leave at a vertex (README)

// ---- layers (layers.h)
inline constexpr double kLayerFaces = 0.1;  // c: what stands nearly upright hides nothing

// ---- integration (sampling.h, level_rule.h)
// Faces within 10 degrees of parallel (fading until 14) are cut where they leave the support radius. At an angle the strips within are narrow, and
// move with the gap, which the frozen Hessian does not know.
inline constexpr double kCutNone = 0.97, kCutFade = 0.015;
inline constexpr double kSlabGrowth = 1.4;             // of the gap over a slab: Gauss rules of six points then err by 1e-12
inline constexpr double kSlabLeast = 1e-3;             // of d_hat: thinner slabs hold no more than rounding of the whole
inline constexpr double kLevel = 1e-7;                 // of the gap: what varies by less over a piece is constant, to 1e-14 of its integral
inline constexpr double kBeside = 1.4142135623730951;  // edges and tips are seen up to the reach above a slave triangle and as far beside it

// ---- frozen gaps (frozen.h)
inline constexpr double kTangent = 0.1;  // of the gap, or of d_hat: below it a frozen barrier goes on along its tangent
inline constexpr double kTurned = 0.05;  // c: beyond 87 degrees the three-term derivative's 1/c rules everything
// No gap of quadratic faces is taken to be smaller than this share of the support radius. Continuous collision detection keeps the quarters
// apart, not the quadratic faces themselves, which a coarse mesh could bring together between its nodes.
inline constexpr double kLeastGap = 1e-3;

// ---- samples that a step may bring into range (mortar_contact.cpp)
inline constexpr double kFarthest = 10;   // of d_hat: samples farther than that from contact are left to the next iteration,
inline constexpr double kNearest = 1e-3;  // and shorter ways bring nothing that matters into range

// ---- averaged gaps (averaged.h)
// Gap up to which samples count, as a multiple of d_hat. A cut at d_hat makes averages jump where samples come within range, so that steps
// do not converge; nodes that reach this far hardly act any more.
inline constexpr double kAverageReach = 10;

// ---- stiffness (stiffness.h)
inline constexpr double kWanted = 4;                    // k: sample pressures are best there on every mesh (README)
inline constexpr double kOpen = 0.7, kSoftest = 0.376;  // least t in statics, in motion
inline constexpr double kFirstPressure = 0.01;          // p / E* before any pressure is known: a strain of a percent
inline constexpr double kRigidClosed = 0.3;             // t of bodies that cannot deform: below it the stiffness is chosen anew
inline constexpr double kSame = 1.5;  // changes of stiffness below this factor move a pressure by less than its mesh does: not worth another solution

// ---- what is reported (report.cpp)
inline constexpr double kWhole = 1e-6;  // of a triangle: pieces that add up to it but for so much should add up to it but for rounding

// ---- supports and the guard (mortar_contact.cpp)
inline constexpr double kLeastSupport = 0.01;  // of d_hat: no support radius is smaller, whatever rest_share says
inline constexpr double kLeastGuard = 0.01;    // of d_hat: what the search looks for even without a guard

}  // namespace mortise::effects::mortar::tuning
