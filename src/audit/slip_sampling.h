#pragma once
// Friction acts where contact has its samples. Where a face bears on its corners alone, as one of few vertices over a plane does, and turns on what
// it bears on, friction takes away what the corners' speed says and not that of the face between them: a box of twelve triangles that spins is braked
// by 1.85 times as much as is right. Between two bodies, with v the speed at which they slip at a place of one body's surface, of the rigid motions
// of both and across the normal, f_k the contact forces on its nodes, shared out by area to the triangles whose nodes all bear, and P_T their sum on
// a triangle,
//
//     c = sum_T sum_k f_k |v_k|,    a = sum_T [sum_k f_k |v_k| - P_T (sum_k |v_k| / 3 - <|v|>_T)],    error = min(c / a, slip of the samples / a) -
//     1,
//
// <>_T: mean over the triangle; slip of the samples: over what presses, of the same force as c; of the body where the error is less (a coarse box on
// a fine table is sampled by the table's nodes). What rolls or slides without turning about the normal has c = a, however little it slips. It counts
// with the energy that friction took away.
#include <cmath>
#include <map>
#include <vector>

#include "audit/friction_pairs.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "geometry/rigid_motion.h"
#include "model/input.h"

namespace mortise::audit {

class SlipSampling {
 public:
  explicit SlipSampling(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<Rubbing>& rubs);
  void step(double dt);  // that led to that state [s]
  // Of the pair where it is most, the mean over what friction took away there; NaN without friction. Pairs where that is less than a share of all
  // do not count.
  double share() const;
  void checkpoint(Archive& archive);

 private:
  struct Body {
    std::size_t first = 0;  // point
    std::vector<Vec3> rest;
    std::vector<Triangle> triangles;
  };
  struct Pair {
    double wrong = 0, taken = 0;  // [J]
    double error = 0, power = 0;  // now; [W]
  };
  struct Fields;
  struct Slip {
    double corners = NAN, faces = NAN;  // mean speeds, c and a over the force [m/s]; NaN where little of what bears is on whole triangles
  };
  geometry::RigidVelocity rigid(std::size_t body, const Fields& f) const;  // at rest of an obstacle
  Slip slip_on(std::size_t body, const geometry::RigidVelocity& own, const geometry::RigidVelocity& under, const Fields& f) const;

  bool rubs_;                 // is there friction?
  std::vector<Body> bodies_;  // that have points
  std::map<Bodies, Pair> pairs_;
};

}  // namespace mortise::audit
