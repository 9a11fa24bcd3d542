#pragma once
// Forces of what goes as it is told where that kinks, with bdf2. An acceleration that changes at once, as between two keys, is overshot: of one that
// begins, x = a t^2 / 2, BDF2 makes 3/4 a h of the velocity, then 2 a h, and of the acceleration 9/8 a, then 3/2 a, whatever the step h. Not
// where the run begins with it: its first steps are short (solver/tuning.h). With c_n = (x_n+1 - 2 x_n + x_n-1)/h^2, which overshoots nothing, and
// a_n what the run takes for the acceleration,
//
//     over = (max m |a_n| - max m |c_n|) / max F,
//
// m: mass of the body; F: the force that holds it in a state, or all that touches it, or m |c|. So of pins and kinematic drives, and of what lies on
// them and goes along, there across the force that presses and with a share of that for F. Where a velocity changes at once (of one c alone, more
// than kSpike of those beside it) forces are as large as steps are short, and nobody asks for them; but where it does so more than kJumps times, as
// that of a track that was sampled and goes straight from key to key, they count as taken. Of kinematic drives the same of their coordinates, with
// M_jj (joint_sums.h) for m and for F what they do.
#include <functional>
#include <string>
#include <vector>

#include "audit/holds.h"
#include "audit/joint_sums.h"
#include "audit/moving_body.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class GivenKinks {
 public:
  explicit GivenKinks(const model::ModelInput& input);
  // forces: F of every body [N].
  void state(const Snapshot& said, const std::vector<double>& points, const std::vector<MovingBody>& bodies, const std::vector<double>& forces);
  double value() const;  // of the body or drive where it is most; NaN where none is told to move, or without bdf2
  void checkpoint(Archive& archive);

 private:
  static constexpr int kKept = 8;
  // Of a body or a drive: states in a row in which it went as it is told; places and velocities of the last ones, the newest last; what of m |a|,
  // m |c| and F was most so far, and of m |a| where the velocity changes at once [N]; how often it did.
  struct Told {
    double states = 0, x[3 * kKept] = {}, v[3 * kKept] = {}, taken = 0, asked = 0, all = 0, jumped = 0, jumps = 0;
    bool goes_on(const Vec3& x, const Vec3& v, double h);  // are there enough states to look?
  };
  using Counts = std::function<Vec3(const Vec3&)>;  // what of a vector does
  void look(Told& told, double m, double force, const Counts& counts) const;

  double step_ = NAN;  // h [s]
  Holds holds_;
  std::vector<std::string> drives_, coordinates_;  // joints with kinematic drives, and what reports of these are called
  JointSums sums_;
  std::vector<Told> bodies_, joints_;
};

}  // namespace mortise::audit
