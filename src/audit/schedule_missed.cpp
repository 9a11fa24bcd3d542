#include "audit/schedule_missed.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "audit/asked.h"
#include "audit/entries.h"
#include "audit/moving_body.h"
#include "audit/tuning.h"
#include "effects/roles.h"

namespace mortise::audit {
namespace {

// Times within a step at which to look, ends included: between two of them what is asked for is nearly straight.
std::vector<double> looks(double t0, double t1, const std::vector<double>& keys) {
  std::vector<double> at;
  for (int k = 0; k <= tuning::kLooks; ++k) at.push_back(t0 + (t1 - t0) * k / tuning::kLooks);
  for (auto key = std::upper_bound(keys.begin(), keys.end(), t0); key != keys.end() && *key < t1; ++key) at.push_back(*key);
  std::sort(at.begin(), at.end());
  return at;
}

double missed(const Asked& asked, double h, long steps) {
  const double start = asked.at(0);
  double beside = 0, all = 0;
  for (long n = 0; n < steps; ++n) {
    const double t0 = h * static_cast<double>(n), t1 = h * static_cast<double>(n + 1), s0 = asked.at(t0), s1 = asked.at(t1);
    const std::vector<double> at = looks(t0, t1, asked.keys);
    for (std::size_t k = 1; k < at.size(); ++k) {
      const auto away = [&](double t) { return std::abs(asked.at(t) - (s0 + (t - t0) / h * (s1 - s0))); };
      const double half = 0.5 * (at[k] - at[k - 1]);
      beside += half * (away(at[k - 1]) + away(at[k]));
      all += half * (std::abs(asked.at(at[k - 1]) - start) + std::abs(asked.at(at[k]) - start));
    }
  }
  return all > 0 ? beside / all : NAN;
}

// Of a force.
double missed_push(const Asked& asked, double h, long steps) {
  double most = 0;  // |s|
  for (long n = 0; n <= steps; ++n) most = std::max(most, std::abs(asked.at(h * static_cast<double>(n))));
  double given = 0, should = 0, largest = 0, missed = 0;
  for (long n = 0; n < steps; ++n) {
    const double t0 = h * static_cast<double>(n), t1 = h * static_cast<double>(n + 1), s0 = asked.at(t0), s1 = asked.at(t1);
    const std::vector<double> at = looks(t0, t1, asked.keys);
    for (std::size_t k = 1; k < at.size(); ++k) should += 0.5 * (at[k] - at[k - 1]) * (asked.at(at[k - 1]) + asked.at(at[k]));
    given += h * s1 - (std::abs(s1 - s0) < tuning::kJumpOfForce * most ? 0.5 * h * (s1 - s0) : 0);
    largest = std::max(largest, std::abs(should));
    if (std::abs(s1) <= tuning::kRounding * most || n + 1 == steps) missed = std::max(missed, std::abs(given - should));
  }
  return largest > 0 ? std::min(2 * missed / largest, 1.0) : NAN;
}

bool rubs(const Params& effects) {
  if (!effects::of_role(effects, effects::Role::follower).empty()) return true;
  const std::vector<Params> drives = entries(effects, "drive");
  return std::any_of(drives.begin(), drives.end(), [](const Params& p) { return p.has("friction"); });
}

// Of load steps.
double cut_short(const Params& effects, long steps) {
  const std::vector<Asked> all = all_asked(effects);
  std::vector<double> keys;
  for (const Asked& asked : all) keys.insert(keys.end(), asked.keys.begin(), asked.keys.end());
  std::sort(keys.begin(), keys.end());

  std::vector<double> span(all.size(), 0.0);  // what each goes through
  const auto way = [&](double from, double to) {
    double square = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (span[i] > 0) square += std::pow((all[i].at(to) - all[i].at(from)) / span[i], 2);
    return std::sqrt(square);
  };
  const std::vector<double> whole = looks(0, 1, keys);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t k = 1; k < whole.size(); ++k) span[i] += std::abs(all[i].at(whole[k]) - all[i].at(whole[k - 1]));
  double chords = 0, length = 0;
  for (long n = 0; n < steps; ++n) {
    const double t0 = static_cast<double>(n) / static_cast<double>(steps), t1 = static_cast<double>(n + 1) / static_cast<double>(steps);
    const std::vector<double> at = looks(t0, t1, keys);
    chords += way(t0, t1);
    for (std::size_t k = 1; k < at.size(); ++k) length += way(at[k - 1], at[k]);
  }
  return length > 0 ? std::max(1 - chords / length, 0.0) : NAN;
}

// Does a quantity look at more than the last state?
bool over_time(const Params& scene) {
  const Params* quantities = scene.find("quantities");
  if (!quantities) return false;
  const auto looks_back = [](const Params& q) { return q.has("at") || (q.text("when") != "end" && q.text("when") != "start"); };
  return std::any_of(quantities->items().begin(), quantities->items().end(), looks_back);
}

// Of what a schedule reaches, what no load step ends with.
double turns_missed(const Params& effects, long steps) {
  double worst = NAN;
  for (const Asked& asked : all_asked(effects)) {
    double seen[2] = {asked.at(0), asked.at(0)}, all[2] = {asked.at(0), asked.at(0)};
    const auto see = [](double(&ends)[2], double s) { ends[0] = std::min(ends[0], s), ends[1] = std::max(ends[1], s); };
    for (long n = 0; n < steps; ++n) {
      const double t0 = static_cast<double>(n) / static_cast<double>(steps), t1 = static_cast<double>(n + 1) / static_cast<double>(steps);
      for (const double t : looks(t0, t1, asked.keys)) see(all, asked.at(t));
      see(seen, asked.at(t1));
    }
    if (all[1] > all[0]) worst = std::fmax(worst, 1 - (seen[1] - seen[0]) / (all[1] - all[0]));
  }
  return worst;
}

}  // namespace

double schedule_missed(const model::ModelInput& input) {
  const Params &effects = input.scene.at("effects"), *time = input.scene.find("time");
  if (!time) return NAN;
  const long steps = time->integer("steps");
  if (time->text("mode") == "static")
    return std::fmax(rubs(effects) ? cut_short(effects, steps) : NAN, over_time(input.scene) ? turns_missed(effects, steps) : NAN);
  const double h = integration_of(input.scene).step;
  double worst = NAN;
  if (std::isnan(h)) return worst;
  for (const Asked& asked : asked_of_drives_and_loads(effects))
    worst = std::fmax(worst, std::fmax(missed(asked, h, steps), asked.pushes ? missed_push(asked, h, steps) : NAN));
  return worst;
}

}  // namespace mortise::audit
