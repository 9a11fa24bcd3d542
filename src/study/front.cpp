// The Pareto front, its knee, and times at the same error.
#include <algorithm>
#include <cmath>
#include <map>

#include "study/compare.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

// What is known of the error: no less than the uncertainty of what it was measured against.
double known_error(const Point& p, const Reference& ref) {
  const double u = std::isfinite(ref.uncertainty) ? ref.uncertainty / ref.scale : 0;
  return std::max({p.error, u, tuning::kRounding});
}

// The point of the front that lies farthest below the straight line from its first to its last (Satopaa et al., Finding a "kneedle" in a haystack,
// ICDCS workshops 2011), both axes logarithmic and scaled to the line's ends; the one in the middle where the front is as good as straight.
std::size_t knee_of(const std::vector<Point*>& front, const Reference& ref) {
  const std::size_t n = front.size();
  std::vector<double> x, y;
  for (const Point* p : front) x.push_back(std::log(std::max(p->seconds, 1e-9))), y.push_back(std::log(known_error(*p, ref)));
  std::size_t best = 0;
  double most = tuning::kBend;
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double along = (x[i] - x[0]) / (x[n - 1] - x[0]), down = (y[0] - y[i]) / (y[0] - y[n - 1]);
    if (down - along > most) most = down - along, best = i;
  }
  return best > 0 ? best : n / 2;
}

}  // namespace

void mark_best(std::vector<Point>& points, const std::vector<Reference>& references) {
  std::map<std::size_t, std::vector<Point*>> order;  // by quantity
  for (Point& p : points) {
    p.best = p.knee = false;
    if (!p.failed && !p.reference && std::isfinite(p.error)) order[p.quantity].push_back(&p);
  }
  for (auto& [quantity, all] : order) {
    const Reference& ref = references[quantity];
    std::stable_sort(all.begin(), all.end(), [&](const Point* a, const Point* b) {
      return a->seconds != b->seconds ? a->seconds < b->seconds : known_error(*a, ref) < known_error(*b, ref);
    });
    std::vector<Point*> front;
    for (Point* p : all)
      if (front.empty() || known_error(*p, ref) < known_error(*front.back(), ref)) p->best = true, front.push_back(p);
    // One that is only the fastest of what the reference cannot tell apart is no front, and recommends nothing.
    if (front.size() == 1 && front.front()->hollow)
      front.front()->best = false;
    else
      front[knee_of(front, ref)]->knee = true;
  }
}

double time_at(const std::vector<const Point*>& curve, double error) {
  double found = NAN;
  const Point* last = nullptr;
  for (const Point* p : curve) {
    if (p->failed || p->reference || !std::isfinite(p->error)) continue;
    if (last && (last->error - error) * (p->error - error) <= 0 && last->error != p->error) {
      const double a = std::log(std::max(last->error, tuning::kRounding)), b = std::log(std::max(p->error, tuning::kRounding));
      const double s = (a - std::log(error)) / (a - b), t = std::exp((1 - s) * std::log(last->seconds) + s * std::log(p->seconds));
      if (!(found <= t)) found = t;
    }
    last = p;
  }
  return found;
}

double front_time_at(const std::vector<Point>& points, std::size_t quantity, double error) {
  std::vector<const Point*> front;
  for (const Point& p : points)
    if (p.quantity == quantity && p.best) front.push_back(&p);
  std::sort(front.begin(), front.end(), [](const Point* a, const Point* b) { return a->seconds < b->seconds; });
  if (!front.empty() && front.front()->error <= error) return front.front()->seconds;
  return time_at(front, error);
}

std::vector<std::pair<std::string, std::vector<const Point*>>> curves_of(const std::vector<Point>& points, std::size_t quantity) {
  std::vector<std::pair<std::string, std::vector<const Point*>>> out;
  for (const Point& p : points) {
    if (p.quantity != quantity) continue;
    auto at = std::find_if(out.begin(), out.end(), [&](const auto& c) { return c.first == p.curve; });
    if (at == out.end()) out.push_back({p.curve, {}}), at = std::prev(out.end());
    at->second.push_back(&p);
  }
  return out;
}

}  // namespace mortise::study
