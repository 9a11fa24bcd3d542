#pragma once
// Ties: blocks that follow others exactly, by equations that are linear with constant scalars,
//
//     q_b = sum_k t_bk q_k + h_b        h_b: what hangs on the world [m, 1]
//
// because x = p + A X is linear in the blocks of a stiff body. Composed along chains, every block is a combination of blocks that follow nothing:
// q = T z + h, T a sparse matrix of scalars (times I3). A tie is exact to rounding, whatever the step and the masses, and has no stiffness,
// multiplier or tolerance. Equations that close a loop are linear in z too: each gives one more block of z, that where its weight is largest, and one
// that says nothing new (a second hinge on the same axis) is left out. All effects go on seeing all blocks; the solver takes their forces and
// matrices back to z:
//
//     residual T^T g,  matrix T^T K T (linalg/elimination.h),  way dq = T dz.
//
// What T^T g takes from a block that follows is the force by which its tie holds it (solver/tie_forces.h).
//
// A tie may be driven: its weights are those of the end of the step (a link at the angle that is asked of it). Its blocks then begin the step beside
// where it wants them, by o_b = sum_k t_bk q_k + h_b - q_b, and go there as supports move what they hold: through the line search.
#include <string>
#include <vector>

#include "base/error.h"
#include "linalg/grouping.h"

namespace mortise::model {

class Model;
using device::Buffer;
using device::View;

struct TieTerm {
  Index block;
  double weight;
};

// An equation that closes a loop, as row . z + constant = 0 over the blocks that follow nothing without such equations.
struct Closing {
  Index tie, place;  // in Tie::closes
  std::vector<TieTerm> row;
  Index pivot;  // the block that it gives
};

// One block and what it follows.
struct Follow {
  Index block;
  std::vector<TieTerm> terms;
  Vec3 fixed = Vec3::Zero();  // h_b
};

struct Tie {
  std::string effect, name;  // who made it; what its figures are called
  SourceLoc where;
  Index body = 0, to = kWorld;
  bool contact = false;  // the two may touch
  std::vector<Follow> follows{};
  std::vector<Follow> closes{};  // equations of the same form that hold as well, of whatever block they give in the end
  Follow anchor{-1, {}};         // the place that its moment is taken about
  // Of a driven one: which effect drives it, and the direction about which its moment on `body` is that of the motor.
  std::string driver{};
  Follow axis{-1, {}};
  bool slides = false;  // it is its force along the axis instead
  bool driven() const { return !driver.empty(); }
  static constexpr Index kWorld = -1;
};

class Ties {
 public:
  // Adds ties between bodies of the model, and puts its state and its velocities on them. Supports must be set. Throws Error(Exit::scene).
  void add(Model& model, std::vector<Tie> ties);

  // The tie is driven by an effect from now on, with these equations in the place of its own; once, before the first step. Throws Error(Exit::scene).
  void hand_over(Model& model, Index tie, std::string driver, std::vector<Follow> follows, Follow axis, bool slides);
  // Equations of driven ties for the step that begins.
  void drive(const Model& model, std::vector<std::pair<Index, std::vector<Follow>>> follows);

  bool any() const { return !blocks_.empty(); }
  bool driven() const { return driven_; }
  Index version() const { return version_; }  // changes with every T
  const std::vector<Tie>& list() const { return ties_; }
  // Every equation, (tie, place in it), such that what a block follows comes before it.
  const std::vector<std::pair<Index, Index>>& order() const { return order_; }
  const std::vector<Closing>& closings() const { return closings_; }
  // Are the two bodies tied to each other by a tie that leaves contact between them out?
  bool pass(Index body_a, Index body_b) const;
  // What a block hangs on in the end: nothing of its own where it is not tied.
  bool tied(Index block) const { return any() && place_[block] >= 0; }
  std::vector<TieTerm> terms(Index block) const;
  Vec3 fixed(Index block) const { return fixed_[place_[block]]; }  // of a tied one: h
  // Every z that a tied block hangs on is held: it goes where supports say.
  bool held(Index block, const std::vector<std::uint8_t>& held) const;

  void place(View<Vec3> q) const;   // q_b <- sum t q + h, of positions
  void carry(View<Vec3> dq) const;  // dq_b <- sum t dq, of their changes
  void fold(View<Vec3> g) const;    // g <- T^T g: what acts on tied blocks goes to those that they follow
  // Where ties are driven:
  void add_offset(View<const Vec3> q, View<Vec3> c) const;      // c_b += o_b
  void add_offset_of(View<const Vec3> c, View<Vec3> dq) const;  // dq_b += c_b - sum t c: the offset that c holds
  void place_after(View<const Vec3> q, View<const double> alpha, View<const Index> block_env,
                   View<Vec3> trial) const;  // of trial = q + alpha dq: all but (1 - alpha) o_b

 private:
  struct Composed;
  void settle(Model& model);
  void compose(const Model& model);
  void close(const Model& model, Composed& all);
  void upload();
  void name_carriages(Model& model) const;
  void start(Model& model) const;

  std::vector<Tie> ties_;
  std::vector<std::pair<Index, Index>> order_;
  std::vector<Closing> closings_;
  std::vector<Index> place_;            // per block of the model: its place in blocks_, or -1
  std::vector<Index> blocks_, offset_;  // tied blocks, ascending; their terms
  std::vector<TieTerm> terms_;
  std::vector<Vec3> fixed_;
  std::vector<std::uint8_t> moving_;  // per tied block: it hangs on a tie that is driven
  bool driven_ = false;
  Index version_ = 0;

  Buffer<Index> block_, start_, of_;  // the same on the device: tied blocks, their first terms, and by term the block that is followed
  Buffer<double> weight_;
  Buffer<Vec3> fixed_on_device_;
  Buffer<std::uint8_t> moving_on_device_;
  Buffer<Index> follower_;     // of every term
  linalg::Grouping followed_;  // terms by the block that is followed
};

}  // namespace mortise::model
