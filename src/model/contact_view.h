#pragma once
// What a contact effect tells about its active samples at a state; friction and the solver read it. A sample is a relative
// position r = sum_k weight[k] * y[point[k]] of surface points (weights sum to 0, or to 1 against an analytic obstacle that
// does not move), with the contact force along a fixed normal.
#include "device/device.h"

namespace mortise::model {

inline constexpr Index kSamplePoints = 12;  // six on each side, for samples on quadratic faces

struct ContactSample {
  Index points = 0;              // how many of the slots are used
  Index point[kSamplePoints];    // point ids
  double weight[kSamplePoints];  // slave side negative, master side positive: gap grows along +normal
  double normal[3];              // unit; force on a point with weight w is force * w * normal
  double position[3];            // where the sample sits [m]
  double force = 0;              // normal force [N]; negative where the sample takes back what others count twice
  double area = 0;               // area the sample stands for [m^2], of the force's sign; 0 where the method has none
  double stiffness = 0;          // -d force / d gap [N/m]
  double gap = 0;                // [m]
  double pressure = 0;           // [Pa], force / area where there is an area
  Index env = 0;
  Index body_a = 0, body_b = 0;  // slave (or first) and master (or second) body; obstacles count after the bodies
};

// Is the other side an obstacle that does not move? Then the normal points at the first body, else away from it. Single weights do not
// tell: shape functions of quadratic faces have both signs.
MORTISE_HD inline bool against_obstacle(const ContactSample& s) {
  double sum = 0;
  for (Index k = 0; k < s.points; ++k) sum += s.weight[k];
  return sum > 0.5;
}

// How a sample of at most four points changes with them: by functionals z_c = sum_k along_ck . dy_k,
//     d force = sum_c force_c z_c,   d normal = sum_c normal_c z_c,   d weight_k = sum_c weight_ck z_c.
struct SampleChange {
  static constexpr int kPoints = 4, kMost = 6;
  Index count = 0;
  Vec3 along[kMost][kPoints];     // [1], or as others ask for
  double force[kMost];            // [N/m]
  Vec3 normal[kMost];             // [1/m]
  double weight[kMost][kPoints];  // [1/m]
};

struct ContactView {
  device::Buffer<ContactSample> samples;  // canonical order, environments contiguous
  device::Buffer<SampleChange> changes;   // of every sample, where that was asked for and is known: else normals and weights count as fixed
  std::vector<Index> env_offset;          // per environment, on the host
  Index blocks = -1, pairs = -1;          // how many a stencil of every sample's points has in all, and pairs of them; -1 where that is not known
  bool local = true;                      // the force of a sample hangs on its own gap alone, by its stiffness
};

}  // namespace mortise::model
