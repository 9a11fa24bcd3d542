#include "study/accuracy_model.h"

#include <algorithm>
#include <cmath>

#include "study/greedy.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

const Rung* rung_at(const Climb& c, int level) {
  for (const Rung& r : c.rungs)
    if (r.level == level) return &r;
  return nullptr;
}

// Over its goal: that of the quantity which misses it most.
double worst_share(const std::vector<Climb>& climbs, const std::vector<double>& goals, const Levels& at, std::size_t& worst) {
  double out = 0;
  for (std::size_t q = 0; q < goals.size(); ++q)
    if (const double share = estimate(climbs, q, at) / goals[q]; !(share <= out)) out = share, worst = q;
  return out;
}

}  // namespace

double Climb::size(int level) const {
  if (const Rung* r = rung_at(*this, level)) return r->size;
  return rungs.back().size * std::pow(ratio, level - rungs.back().level);
}

double Climb::cost(int level) const {
  if (const Rung* r = rung_at(*this, level)) return r->cost;
  const Rung& last = rungs.back();
  double power = dearer;
  if (rungs.size() > 1) {
    const Rung& before = rungs[rungs.size() - 2];
    const double seen = std::log(last.cost / before.cost) / std::log(before.size / last.size);
    if (std::isfinite(seen)) power = std::clamp(seen, 0.5 * dearer, 1.5 * dearer);
  }
  return last.cost * std::pow(last.size / size(level), power);
}

Limit Climb::limit(std::size_t q) const {
  std::vector<double> sizes, values;
  for (const Rung& r : rungs) sizes.push_back(r.size), values.push_back(r.values[q]);
  if (const std::size_t n = values.size(); n != 2) {
    Limit out = limit_of(sizes, values);
    if (n < 3 || (out.extrapolated && out.order <= tuning::kTrustedOrder)) return out;
    const double near = values[n - 1] - values[n - 2], far = values[n - 2] - values[n - 3];
    const double scatter = tuning::kSafety * std::max(std::abs(near), std::abs(near + far));
    const bool grows = near * far > 0 && std::abs(near) > std::abs(far);
    out = {values[n - 1], false, 0, grows ? std::max(scatter, tuning::kUnknownOrder * std::abs(near)) : scatter,
           "the finest run, and how the last three scatter"};
    return out;
  }
  // Of two runs the order is a guess: 1.
  const double change = values[1] - values[0], step = change * sizes[1] / (sizes[0] - sizes[1]);
  return {values[1] + step, true, 1, std::max(tuning::kUnknownOrder * std::abs(change), tuning::kSafety * std::abs(step)), "a guess from two runs"};
}

double Climb::value(std::size_t q, int level) const {
  if (const Rung* r = rung_at(*this, level)) return r->values[q];
  const Limit l = limit(q);
  return l.value - (l.value - rungs.back().values[q]) * std::pow(size(level) / rungs.back().size, l.extrapolated ? l.order : 1);
}

double Climb::left(std::size_t q, int level) const {
  if (parts.empty()) return limit(q).value - value(q, level);
  double sum = 0;
  for (const Part& p : parts) sum += p.left[q] * std::pow(size(level), p.order);
  return sum;
}

double Climb::error(std::size_t q, int level) const {
  if (!parts.empty()) return std::abs(left(q, level));
  const Limit l = limit(q);
  if (blind || std::isnan(l.uncertainty)) return INFINITY;
  const double smaller = level >= rungs.back().level ? std::pow(size(level) / rungs.back().size, l.extrapolated ? l.order : 1) : 1;
  return std::max(std::abs(l.value - value(q, level)), l.uncertainty * smaller);
}

bool Climb::settles(std::size_t q) const {
  if (!parts.empty()) return std::isfinite(error(q, 0));
  const Limit l = limit(q);
  return !blind && (l.extrapolated || l.uncertainty == 0);
}

void Climb::add(Rung rung) {
  const auto after = std::find_if(rungs.begin(), rungs.end(), [&](const Rung& r) { return r.level >= rung.level; });
  if (after != rungs.end() && after->level == rung.level)
    *after = std::move(rung);
  else
    rungs.insert(after, std::move(rung));
}

Climb Climb::around(int level, const std::vector<double>& at) const {
  Climb out = *this;
  out.rungs.clear(), out.finest -= level;
  const auto moved = [&](const Rung& r) {
    Rung to{r.level - level, r.size / size(level), {}, r.cost / cost(level)};
    for (std::size_t q = 0; q < at.size(); ++q) to.values.push_back(at[q] + r.values[q] - value(q, level));
    return to;
  };
  for (const Rung& r : rungs) out.add(moved(r));
  out.add({0, 1, at, 1});
  return out;
}

double estimate(const std::vector<Climb>& climbs, std::size_t q, const Levels& at) {
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < climbs.size(); ++k) {
    const double error = climbs[k].error(q, at[k]);
    sum += climbs[k].left(q, at[k]), squares += error * error;
  }
  return std::max(std::abs(sum), std::sqrt(squares));
}

bool settles(const std::vector<Climb>& climbs, std::size_t q, double goal) {
  return std::all_of(climbs.begin(), climbs.end(), [&](const Climb& c) { return c.settles(q) || c.error(q, 0) <= tuning::kAlone * goal; });
}

Chosen choose_levels(const std::vector<Climb>& climbs, const std::vector<double>& goals, double share, const Levels& from, double most_cost) {
  Chosen out{from, 1, false, 0};
  for (;;) {
    out.cost = 1;
    for (std::size_t k = 0; k < climbs.size(); ++k) out.cost *= climbs[k].cost(out.levels[k]);
    if (worst_share(climbs, goals, out.levels, out.worst) <= share) return out.reached = true, out;
    // One step of one knob at a time, to the next level that is any better: of a ladder that does not settle finer runs may be there that are not.
    std::vector<Knob> knobs;
    Levels next = out.levels;
    for (std::size_t k = 0; k < climbs.size(); ++k) {
      const Climb& c = climbs[k];
      Knob knob;
      knob.base_error = c.error(out.worst, out.levels[k]);
      do ++next[k];
      while (next[k] <= from[k] + tuning::kFarthest && !(c.error(out.worst, next[k]) < knob.base_error));
      if (next[k] <= c.finest && knob.base_error > tuning::kAlone * estimate(climbs, out.worst, out.levels)) {
        knob.error.push_back(c.error(out.worst, next[k]));
        knob.cost.push_back(c.cost(next[k]) / c.cost(out.levels[k]));
      }
      knobs.push_back(knob);
    }
    const auto move = best_move(knobs, std::vector<std::size_t>(knobs.size(), kBase), most_cost / out.cost);
    if (!move || next[move->knob] > from[move->knob] + tuning::kFarthest) return out;
    if (out.levels == from) out.first = move->knob;
    out.levels[move->knob] = next[move->knob];
  }
}

}  // namespace mortise::study
