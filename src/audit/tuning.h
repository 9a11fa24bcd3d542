#pragma once
// Every number of this folder that was chosen and that a verdict hangs on.
#include <cstddef>

namespace mortise::audit::tuning {

// ---- grades: what the errors of a result may be for it to be called good (A) or usable (B) (certificate_grade.cpp)
struct Bounds {
  double good, usable;
};
inline constexpr Bounds kResidual{1.01e-3, 1e-2};  // of the largest force: friction's default lag_tolerance, and rounding, are no reason for a B
inline constexpr Bounds kBalance = kResidual;      // of forces, on all bodies and on each with its supports: residuals add up to it
inline constexpr Bounds kWritten{1e-5,
                                 1e-3};  // the same forces added up twice; of small ones between bodies far from the origin rounding leaves 2e-6
inline constexpr Bounds kPressureSum{1e-6, 1e-3};  // pressure times area against force, over thousands of samples
inline constexpr Bounds kPartition{1e-5, 1e-3};    // pieces of a covered face against the face: slivers are left out
inline constexpr Bounds kRigidity{2e-3, 2e-2};    // of the axes of a stiff body: strains that its material would not have either, and ten times those
inline constexpr Bounds kEnergyGain{1e-3, 1e-2};  // of the largest energy; dissipative steps gain none
// From here on estimates of errors of the model, whose bounds are what they are where the true error is 5 % and 10 % (benchmarks/grades).
inline constexpr Bounds kFreeMotionLoss{0.05, 0.1};
inline constexpr Bounds kStiffImpacts{0.05, 0.1};
inline constexpr Bounds kTurningLoss{
    0.06, 0.12};  // of energy: rates of what rolls are wrong by a fifth to four fifths of it, and angles of what friction stops
inline constexpr Bounds kMotionLag{0.05, 0.1};
inline constexpr Bounds kGivenLag{0.045, 0.09};  // of forces: a sine of 140 and of 70 steps, whose largest errors are 5 and 10 % of its amplitude
inline constexpr Bounds kMotorLag{0.05, 0.1};
inline constexpr Bounds kFacetTorque{0.05, 0.1};
inline constexpr double kEvens = 0.1;  // of d_hat: facets less deep are evened out by the layer (a cam and a friction wheel, edges of 1 to 5 mm)
inline constexpr Bounds kBuckling{0.05, 0.1};       // of forces beyond what a column bears
inline constexpr Bounds kBondOverlap{0.03, 0.055};  // of forces and ways; half of what they are wrong by, or more, is told
inline constexpr double kFull =
    0.6;  // of the box with its radii of gyration: a ring or an arch has less, and no line that is shortened (buckling.cpp)
inline constexpr double kSlender = 4;         // of a bar's length, over its thickness: shorter ones are crushed before they give way
inline constexpr Bounds kWorkLag{0.05, 0.1};  // of work: a smooth lift in 100 and in 50 steps
inline constexpr double kWorkOfMost = 0.1;    // what goes there and back ends with next to no work
inline constexpr Bounds kGivenKinks{0.05, 0.1};
inline constexpr Bounds kCarriedForce{0.05, 0.1};
inline constexpr Bounds kStruck{0.05, 0.1};
inline constexpr Bounds kLateInertia{0.05, 0.1};
inline constexpr Bounds kSlipReversal{0.05, 0.1};
inline constexpr Bounds kGuard{0.02, 0.1};
inline constexpr Bounds kStress{0.05, 0.1};
inline constexpr Bounds kRoughness{0.03, 0.04};
inline constexpr Bounds kMisfit{0.01, 0.0125};
// Who asks for small rotations takes terms of second order for granted, as the formulas do that such results are compared with: bounds beyond those.
inline constexpr Bounds kTurned{0.2, 0.4};
inline constexpr Bounds kLayer{0.03, 0.06};
inline constexpr Bounds kLayerOverWay{0.05, 0.1};
inline constexpr Bounds kLoadTurned{0.05, 0.08};     // a thick tube that is blown up: 1.2 times its growth is missing
inline constexpr Bounds kShape{0.025, 0.05};         // of volume: half of that of stiffness against bending
inline constexpr Bounds kFrictionTurned{0.05, 0.1};  // of friction: what is across the direction that it should have
inline constexpr Bounds kCrept{0.02, 0.035};         // a pad that was sheared and held lost 23 % of its force at 0.041
inline constexpr Bounds kTouchLag{0.05, 0.1};
inline constexpr Bounds kSlipSampling{0.05, 0.1};
inline constexpr Bounds kStiffStrain{0.025, 0.05};  // about the middle: one end is off by twice that from the other
inline constexpr Bounds kMissed{0.05, 0.1};         // of what is asked for: a sine with eight steps in a period, and with six
inline constexpr Bounds kGivenTurning{0.1, 0.2};    // of energy, as of turning bodies
inline constexpr Bounds kQuantity{0.05, 0.1};       // an estimate of the error itself
inline constexpr Bounds kAtStart{0.1, 0.2};         // of energy: half of that of velocities

// ---- what counts in them
inline constexpr double kRounding = 1e-12;  // of positions: some thousand times what one rounding makes (certificate.cpp)
inline constexpr double kStrain = 1e-10;    // far below any strain that means something, far above what rounding of positions makes (certificate.cpp)
inline constexpr double kDriven =
    1e-6;  // work in a step, of the largest energy: less is what holding takes; and the least of what is not given (state_audit.cpp)
inline constexpr double kNoWay = 1e-9;  // of a body's radius, in a step: less is rounding (state_audit.cpp)
inline constexpr double kRolls = 0.5;   // its farthest point, from turning, over its velocity (turning_loss.cpp): sliding bodies turn less
inline constexpr double kWheel = 1;     // [rad]: a leg or a finger that rolls on its tip turns back before that (turning_loss.cpp)
inline constexpr double kTurns =
    1e-3;  // of the energy of motion of a body in flight: with less its rim turns by less than a twentieth of its way (spin_loss.cpp)
inline constexpr double kToAndFro = 0.1;  // of a body's radius: by less it rocks or settles (to_and_fro_loss.cpp)
inline constexpr double kSpun = 1;        // [rad]: what anybody sees, however far the body goes (spin_loss.cpp)
inline constexpr double kSticks = 0.5;    // of what friction takes, where it sticks: with more nothing slips (slip_sampling.cpp)
inline constexpr double kUpright = 0.2;   // across the force below, of the spin: what rolls or rocks has more (spin_loss.cpp)
inline constexpr double kWeight = 0.5;    // of the change of velocity of a contact: when weight does more of it, it is no bounce (bounce_loss.cpp)
// Of the energy of motion: with less along the change nobody looks at a bounce, a tenth of the speed, or at a hop of stiff bodies, a third
// (bounce_loss.cpp).
inline constexpr double kSeen = 0.01, kSeenStiff = 0.1;
inline constexpr double kImpact = 0.1;  // of the energy of what rolls, in a step: more is no rolling
inline constexpr double kSlow = 0.01;   // of the energy before a contact: a body that has less, in kRestedShare of the steps of that contact and in
inline constexpr double kRested = 4,
                        kRestedShare = 0.3;  // kRested of them, came to rest there (bounce_loss.cpp; at the turn of a bounce: 6 % of them)
inline constexpr double kNoticeably = 2e-3;  // of a soft body's thickness: pressed by less, as by its own weight, is at rest (stiffness_error.cpp)
// shape_defect.h: what is remeshed is not touched where its file says either (a sleeve pressed by a quarter of its thickness: forces 4, 6, 11 and 12
// % too small where 1.5, 2.8, 3.7 and 4.1 % of its volume lie between the surfaces).
inline constexpr double kRemeshed = 1.5;
// A support whose force has less of the direction of the contact force is a guide (layer_error.cpp): rollers beside a skin go down with it.
inline constexpr double kBears = 0.05;
// touch_lag.h: shear that is less than this share of what presses is none that anybody looks at; of the way that was counted too much, force has the
// second share, as nodes around that stick already hold it (balls pressed aslant, 1 to 48 steps).
inline constexpr double kAcross = 0.1, kSoftened = 0.7;
inline constexpr double kMultiplies = 0.3,
                        kAsFast = 0.75;      // in a step: more is a push; growth of acceleration over that of velocity (lagging_ways.cpp)
inline constexpr double kStillStiff = 1e-3;  // of a stiff body's radius: less than that it moves as it settles on a layer (stiff_strain.cpp)
inline constexpr double kStill = 0.01;  // of a body's size: less is no motion that anybody looks at (motion_lag.cpp, carried_lag.cpp, swing_loss.cpp)
// motor_lag.h: parts of a step, which leave a thirtieth of its error; and the share of the largest torque of all motors that a motor's own counts as
// no less than.
inline constexpr int kMotorParts = 32;
inline constexpr double kFaint = 0.01;
inline constexpr long kBegins = 3;           // states: BDF2 has its history then (motor_lag.cpp, given_kinks.cpp)
inline constexpr double kPeak = 1. / 3;      // of the second difference of accelerations: what BDF2 errs by in them (struck.cpp)
inline constexpr double kRoundedWay = 1e-7;  // of the size of what a motor moves: the torque of so little is that of a robot that stands still
inline constexpr double kOtherWay = 0.5;     // of a motor's largest torque: that the other way counts as no less than (motor_lag.cpp)
inline constexpr double kForgets = 0.6, kFits = 0.95, kApart = 1e-6;  // of a swing: what a state weighs in the next one, what
                                                                      // has to follow, and how far r and r' are apart (fitted_swing.h)
inline constexpr double kSettled = 0.1;                               // of what its acceleration changed by at most (carried_force.h)
inline constexpr double kPerRadian = 8;                               // steps of its own swing: below 1e-3 of it
inline constexpr double kBrings = 0.25;       // of the square of what presses: less, in the same measure, is no strike (struck.h)
inline constexpr double kJumps = 10;          // of given velocities: starts and stops of some phases, no sampled track (given_kinks.h)
inline constexpr double kSpike = 2.5;         // an acceleration beside those of the steps next to it: more is a velocity that jumps (given_kinks.cpp)
inline constexpr double kSettles = 0.05;      // radians, or of a body on a slide: less is how joints settle (bearing_creep.cpp)
inline constexpr double kJumpOfForce = 0.5;   // of its largest, in a step (schedule_missed.cpp)
inline constexpr int kLooks = 16;             // in a step, at what is asked for (schedule_missed.cpp)
inline constexpr double kCompressible = 0.4;  // most of Poisson's ratio of what bubbles resist with (bubble_error.cpp), and of strain_energy.cpp
inline constexpr double kHeldMisses = 1.5;    // times what bubbles miss of pads of one and two elements between plates (bubble_error.cpp)
inline constexpr double kOnTie = 0.25;        // of a side of a face: nearer it lies on what is tied to it (bubble_error.cpp)
inline constexpr double kNotAffine = 0.5;     // of the farthest way of a body's points, as seen from where it is held (stress_error.cpp)
inline constexpr std::size_t kSlices = 8;     // of a body, along each of its axes (stress_error.cpp)
inline constexpr double kLeastBent = 0.05;    // of how far a body deforms: beside that nobody looks at how it bends (stress_error.cpp)
inline constexpr double kHidden = 0.25;       // of the energy of a body: what varies is hidden by what is uniform (stress_error.cpp)
inline constexpr double kAmplified = 5;       // times at most: beyond it, what has buckled stands firm again (stress_error.cpp)
inline constexpr double kFacesContact = 0.5;  // of a force of contact, against the normal of the face that it is on (bubble_error.cpp)
inline constexpr int kBubbleIterations = 100;     // of conjugate gradients: twenty do, of slivers more (bubble_error.cpp)
inline constexpr double kBubbleTolerance = 1e-4;  // of squared residuals (bubble_error.cpp)
inline constexpr double kMostMissed = 0.9;        // of an energy (bubble_error.cpp)
inline constexpr double kOnAxis = 0.1;            // of a round body's radius, and of 1: nearer to its axis is a hinge on it (shape_defect.cpp)
inline constexpr double kDamped = 10;             // times what the time step damps: amplitudes are right within a tenth (holds.cpp)
inline constexpr double kTrembles = 1e-3;         // of a stiff body's radius: by less it gives way itself (vibration_loss.cpp)
inline constexpr double kShownBySwing = 0.6;      // of the most elastic energy: beside that a smaller one of motion is nothing (swing_loss.cpp)
inline constexpr double kOneSided = 0.5;          // of the forces on a body: what is pressed from both sides lies on neither (moving_body.cpp)
inline constexpr double kSlips = 0.02;            // of the fastest slip of a body: slower it sticks (slip_reversal.cpp)
inline constexpr double kSetsIn = 0.5;            // of an acceleration, in three steps: that of a carrier jumps (slip_onset.cpp)
inline constexpr long kFromRest = 2;              // steps: what is carried from then on was so from the start, and at rest (carried_lag.cpp)
inline constexpr double kStuck = 0.1;             // of that jump: by so much the accelerations of what sticks may differ from the carrier's
inline constexpr double kSetsOff = 4;             // times the changes of velocity beside it: what a carrier's speed jumps by (carried_lag.cpp)
inline constexpr double kShakes =
    1e-6;  // of a body's size, in a step: less of what moves under it is rounding (to_and_fro_loss.cpp, slip_reversal.cpp)
inline constexpr double kHardly = 1e-3;       // of the least way, in a step: what bodies on joints give (carried_lag.cpp)
inline constexpr double kCarriedStill = 0.1;  // of a body's size: less is no way along what carries it that anybody looks at (carried_lag.cpp)
// Errors of the ways of four gaits at 2.5 to 10 ms were 1.3 to 7 times the sums without these, most 3 to 4 with backward Euler, and 1 to 10 times
// with bdf2 (walking_lag.cpp).
inline constexpr double kWalksDamped = 3, kWalks = 7;
inline constexpr double kOneWay = 0.1;        // forces from opposite sides have no resultant that supports could bear (layer_error.cpp)
inline constexpr double kAsMuch = 0.01;       // of the most pressure: loads that are held waver by that (field_errors.cpp)
inline constexpr double kStillLoaded = 0.01;  // of the most force: less is what unloading leaves (field_errors.cpp; of energy its square)
inline constexpr double kCounts = 1e-3;       // of the most pressure or force: bodies with less may be no better solved than that (residual_share)
inline constexpr double kNoticed = 3e-3;  // of the most stress, roughly: what a phase changes by less is what steps leave unsolved (field_errors.cpp)
inline constexpr std::size_t kPhases = 16;  // keys: a schedule with more draws a curve (asked.cpp)
inline constexpr double kFacing = 0.5;      // cosine of 60 degrees: friction may tilt the force by half of that (contact_patch.cpp)
inline constexpr double kBearing = 0.9;  // of the force on whole triangles: otherwise edges and corners bear, which have no face (slip_sampling.cpp)
inline constexpr double kSqueezed =
    0.9;  // of the force, that a travel decides: what is wedged between stiff bodies by a load has a part of it too (layer_error.cpp)
inline constexpr double kSmooth = 0.75;  // cosine of some 40 degrees: facets of a coarse ball meet at half of that, sides of a body at more
inline constexpr double kWhole = 0.97;   // of a node's area: less lies over what presses, and one pressure for all of it is none (contact_patch.cpp)
inline constexpr double kWidened =
    0.8;  // of the last element: forces of flat punches of 2.5 to 7.5 elements a radius are 0.6 to 1 times that too large
inline constexpr double kBeside = 1.5;    // sizes of the mesh between a sharp edge and the last node inside of it (rim_error.cpp)
inline constexpr double kPart = 0.1;      // of the strongest patch's force: others decide less (rim_error.cpp)
inline constexpr double kPieces = 1000;   // of an edge at most, half as long as elements (rim_error.cpp)
inline constexpr double kFlat = 0.05;     // the ring of a node lies nearly in a plane: no slope across it (pressure_error.cpp)
inline constexpr std::size_t kPlane = 4;  // neighbours: a plane through three has no say about a fourth
inline constexpr double kWithin = 0.6;    // of energy: sheared and turned cubes of one quadratic element are 12 to 24 % too stiff, bent beams 1 to 10
                                          // %, bonded pads 1 % (stress_error.cpp)
inline constexpr double kWithinOfMeans = 0.3;  // the same where volumes are averaged: 14 to 18 % too stiff, beams 4 % too soft
inline constexpr double kPressed =
    2.2;  // times what jumps miss: balls on quadratic pads, 0.4 to 1.2 edges in the contact's radius (stress_error.cpp)
inline constexpr double kQuadraticLocks = 0.49;  // nu: without averages quadratic elements are a few percent too stiff there (benchmarks/locking)

}  // namespace mortise::audit::tuning
