#pragma once
// What every environment of a batch is doing within a step: a row of one table. All of them go through the same loop; none knows the others.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/types.h"

namespace mortise::solver {

using EnvMask = std::vector<std::uint8_t>;
inline bool any(const EnvMask& m) { return std::find(m.begin(), m.end(), 1) != m.end(); }

enum class EnvState : std::uint8_t {
  running,  // Newton goes on
  settled,  // solved with the present lagged quantities
  stuck,    // waits for the coupled iteration
  solved,   // in this step
  failed
};

struct EnvStatus {
  EnvState state = EnvState::running;
  double alpha = 0;                                     // share of the last step that was taken; 0 before the first
  double step = 0;                                      // longest move of a block in the last step at full length [m]
  double force = 0;                                     // residual before the last iteration [N]; 0 before the first
  double sum = 0;                                       // and that of a whole body, where it is largest
  double energy = 0;                                    // Phi there [J],
  double concave = 0;                                   // and how much of its negative curvature the matrix kept
  double stretch = 1;                                   // what its next way is multiplied by (saddle_policy.h)
  bool whole = false;                                   // lagged quantities are those of every iterate, and directions those of the whole Jacobian
  bool moving = false;                                  // so are those of what is frozen beside them (moving_policy.h)
  bool unsymmetric() const { return whole || moving; }  // its directions are of more than the Hessian
  int refused = 0;                                      // far steps of what only contact holds that were not taken (loose_hold.h)
  bool circles = false;                                 // between two states: what is looked for lies between them
  bool arrived = false;                                 // supports stand on their targets
  bool may_couple = false;                              // the coupled iteration may be tried,
  double couple_below = INFINITY;                       // where a residual is less than this [N]: farther away it has failed
  int coupled = 0;                                      // times that it has failed in this step
  std::string reason;                                   // of a failure
};

class EnvTable {
 public:
  explicit EnvTable(Index envs) : rows_(envs) {}
  Index size() const { return static_cast<Index>(rows_.size()); }
  EnvStatus& operator[](Index e) { return rows_[e]; }
  const EnvStatus& operator[](Index e) const { return rows_[e]; }
  bool is(Index e, EnvState s) const { return rows_[e].state == s; }
  bool any(EnvState s) const {
    for (const EnvStatus& row : rows_)
      if (row.state == s) return true;
    return false;
  }
  EnvMask mask(EnvState s) const {
    EnvMask out;
    for (const EnvStatus& row : rows_) out.push_back(row.state == s);
    return out;
  }
  void change(EnvState from, EnvState to) {
    for (EnvStatus& row : rows_)
      if (row.state == from) row.state = to;
  }
  void fail(Index e, const std::string& reason) { rows_[e].state = EnvState::failed, rows_[e].reason = reason; }

 private:
  std::vector<EnvStatus> rows_;
};

}  // namespace mortise::solver
