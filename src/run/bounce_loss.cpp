#include "run/bounce_loss.h"

#include <algorithm>

#include "run/tuning.h"

namespace mortise::run {

namespace {

// What hangs together.
struct Group {
  double moves = 0, turns = 0;  // energy of motion of the centres, and of turning [J]
  bool touches = false, given = false, swings = true;
};

}  // namespace

void BounceLoss::state(const std::vector<MovingBody>& bodies, double lost) {
  if (bodies.empty()) return;
  if (steps_.empty())
    for (std::vector<double>* v : {&steps_, &slow_, &before_, &lost_, &soft_}) v->assign(bodies.size(), 0.0);
  std::vector<Group> groups(bodies.size());
  for (const MovingBody& b : bodies) {
    Group& g = groups[b.group];
    g.moves += b.energy(), g.turns += b.turns;
    g.touches = g.touches || b.touches || b.stopped, g.given = g.given || b.given, g.swings = g.swings && b.swings;
  }
  const bool soft = std::any_of(bodies.begin(), bodies.end(), [](const MovingBody& b) { return b.body.soft() && b.touches; });
  double ended = 0, flies = 0, impact = 0;
  brought_ = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const Group& g = groups[i];
    if (bodies[i].group != i || g.given) continue;
    const double energy = bodies[i].free ? g.moves : g.moves + g.turns;  // what is free turns as it likes
    if (steps_[i] > 0) lost_[i] += lost;                                 // in the step that ends a contact, too
    if (!g.touches) {
      const bool rested = slow_[i] >= tuning::kRested && slow_[i] >= tuning::kRestedShare * steps_[i];
      if (g.swings && steps_[i] > 0 && !rested) {
        if (soft_[i] > 0)
          ended = std::max(ended, std::min(lost_[i], before_[i]));
        else
          flies += g.moves + g.turns, impact = std::max(impact, lost_[i]);
      }
      steps_[i] = -1, before_[i] = energy;
      continue;
    }
    if (steps_[i] < 0) steps_[i] = slow_[i] = lost_[i] = soft_[i] = 0, brought_ += before_[i];
    if (before_[i] == 0) continue;  // it touched from the start
    if (++steps_[i] == 1) lost_[i] += lost;
    if (soft) soft_[i] = 1;
    if (energy < tuning::kSlow * before_[i]) ++slow_[i];
  }
  sum_ += ended, stiff_ += std::min(flies, impact);
}

void BounceLoss::checkpoint(Archive& archive) {
  for (auto [name, v] :
       {std::pair{"bounce.steps", &steps_}, {"bounce.slow", &slow_}, {"bounce.before", &before_}, {"bounce.lost", &lost_}, {"bounce.soft", &soft_}})
    archive.io(name, *v);
  archive.io("bounce.sum", sum_);
  archive.io("bounce.stiff", stiff_);
}

}  // namespace mortise::run
