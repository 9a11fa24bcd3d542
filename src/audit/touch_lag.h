#pragma once
// What comes to touch within a step sticks from the beginning of that step: friction takes the whole of its slip, also what came before the touch.
// Where supports give the ways of both bodies, shear is too large by that. Of every node i of a soft body that touches another, with D the way of
// that body's supports less those of the other in a step, seen at the node and across the mean force between the two, and f the contact force,
//
//     way_i = sum of D since the node touched,
//     late_i <- (1 - g) late_i + g |D| / 2 - slip of the step, 0 at least,     g = 1 - |f before| / |f|, 0 at least: what is new of the contact,
//     lag = kSoftened |sum_i F_i . d_i late_i / |way_i|| / max(|sum_i F_i . d_i|, kAcross sum_i |f_i|),     d_i = way_i / |way_i|,
//
// F: friction force on the node. Twice as many steps halve it; of a press and a shove in two phases there is none. Between two bodies, of which the
// worst pair counts, at the state that is sheared most and at the last one. Where most of the contact slips it is several times too large.
// Not seen: what bodies that are free squeeze or carry, and bodies that touch more than one other.
#include <map>
#include <utility>
#include <vector>

#include "audit/layer_error.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class TouchLag {
 public:
  explicit TouchLag(const model::ModelInput& input);
  void state(const Snapshot& said);  // after a step, or at the start
  void step(long substeps);          // that led to that state, in so many parts
  double share() const;              // NaN without friction
  void checkpoint(Archive& archive);

 private:
  using Bodies = std::pair<std::size_t, std::size_t>;
  struct Body {
    std::size_t first, count;  // points
    bool soft, given;          // given: its supports go as the scene says
    geometry::Motion before{}, now{};
  };
  struct Node {
    double force = 0;         // |f| [N]
    Vec3 way = Vec3::Zero();  // [m]
    double late = 0;          // [m]
    // Of the last step.
    double begun = 0, slip = 0;    // what is added to `late`; how far it slipped [m]
    Vec3 friction = Vec3::Zero();  // [N]
  };
  struct Judged {
    double sheared, lag;  // the denominator [N], and the share
  };
  Judged judge(std::size_t body, double pressed) const;
  struct Fields {
    const Snapshot::Values &displacement, &contact, &friction;
  };
  void move_supports(const Snapshot& said, const Snapshot::Values& displacement);
  void touch(std::size_t body, std::size_t other, const Fields& f);
  Vec3 gone(std::size_t point, const Fields& f) const;  // in the last step [m]
  Vec3 led(std::size_t body, const Vec3& x) const;      // in the last step, by its supports alone [m]
  // What a body has gone in the last step at x: of a soft one its point nearest to x that touches.
  Vec3 gone_at(std::size_t body, const Vec3& x, const Fields& f) const;

  std::vector<Body> bodies_;  // that have points; obstacles have later numbers
  std::vector<Vec3> rest_;    // of all points
  std::vector<Node> nodes_;   // of all points
  bool rubs_ = false;
  LayerError supports_;
  std::vector<double> before_;           // displacement of the state before; empty: none
  std::map<Bodies, double> pressed_;     // sum of |f| in the last state [N]
  std::map<Bodies, Judged> now_, most_;  // the first one is soft
};

}  // namespace mortise::audit
