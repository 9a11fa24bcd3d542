#include "run/reset_watch.h"

#include <fmt/format.h>

#include "run/reported.h"

namespace mortise::run {

ResetWatch::ResetWatch(const std::vector<Params>& conditions, const model::ModelInput& input) : conditions_(conditions), scene_(input.scene) {
  for (const Params& c : conditions_) {
    if (!c.has("body")) continue;
    std::size_t first = 0;
    for (const model::BodyInput& b : input.bodies) {
      if (b.name == c.text("body")) bodies_.emplace_back(b, first);
      first += b.nodes.size();
    }
  }
}

void ResetWatch::check(const Snapshot& start) const {
  for (const Params& c : conditions_)
    if (c.has("quantity") && !may_report(c.text("quantity"), scene_, start))
      not_reported(c.where(), "environments.reset", c.text("quantity"), scene_, start);
}

void ResetWatch::see(long step, double time, const Snapshot& said, const std::vector<double>& points) {
  if (due_ >= 0 || step == 0) return;
  std::size_t body = 0;
  for (std::size_t i = 0; i < conditions_.size(); ++i) {
    const Params& c = conditions_[i];
    double value = 0;
    bool met = false;
    if (c.has("after")) {
      value = time;
      met = time >= c.number("after") * (1 - 1e-12);  // times are multiples of a step, rounded
    } else if (c.has("body") || c.has("quantity")) {
      if (c.has("body")) {
        value = bodies_[body++].mean(points, points)[c.text("axis")[0] - 'x'];
      } else if (said.has(c.text("quantity"))) {
        value = said.number.at(c.text("quantity"));
      } else {
        not_reported(c.where(), "environments.reset", c.text("quantity"), scene_, said);
      }
      met = (c.has("above") && value > c.number("above")) || (c.has("below") && value < c.number("below"));
    }
    if (!met) continue;
    due_ = static_cast<long>(i), value_ = value;
    return;
  }
}

std::string ResetWatch::reason() const {
  const Params& c = conditions_.at(due_);
  if (c.has("after")) return fmt::format("after {:.6g} s", c.number("after"));
  const std::string what = c.has("body") ? c.text("body") + " " + c.text("axis") : c.text("quantity");
  const bool above = c.has("above") && value_ > c.number("above");
  return fmt::format("{} = {:.6g} {} {:.6g}", what, value_, above ? "above" : "below", c.number(above ? "above" : "below"));
}

void ResetWatch::checkpoint(Archive& archive) {
  double due = static_cast<double>(due_);
  archive.io("due", due);
  archive.io("value", value_);
  due_ = static_cast<long>(due);
}

}  // namespace mortise::run
