#include "run/reset_watch.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "scene/suggest.h"

namespace mortise::run {

ResetWatch::ResetWatch(const std::vector<Params>& conditions, const model::ModelInput& input) : conditions_(conditions) {
  for (const Params& c : conditions_) {
    if (!c.has("body")) continue;
    std::size_t first = 0;
    for (const model::BodyInput& b : input.bodies) {
      if (b.name == c.text("body")) bodies_.emplace_back(b, first);
      first += b.nodes.size();
    }
  }
}

void ResetWatch::check(const Params& scene, const Snapshot& start) const {
  std::vector<std::string> groups{"supports", "balance", "audit"};
  for (const auto& [name, effect] : scene.at("effects").entries()) groups.push_back(name);
  for (const auto& [name, number] : start.number) groups.push_back(name.substr(0, name.find('/')));
  for (const Params& c : conditions_) {
    if (!c.has("quantity") || start.has(c.text("quantity"))) continue;
    const std::string& quantity = c.text("quantity");
    const std::size_t slash = quantity.find('/');
    if (slash != std::string::npos && std::find(groups.begin(), groups.end(), quantity.substr(0, slash)) != groups.end()) continue;
    unknown(c, start);
  }
}

void ResetWatch::unknown(const Params& condition, const Snapshot& said) {
  const std::string& quantity = condition.text("quantity");
  std::vector<std::string> known;
  for (const auto& [name, number] : said.number) known.push_back(name);
  const std::string hint = scene::suggestion(quantity, known);
  throw Error(Exit::scene, condition.where(), "environments.reset: nothing reports '" + quantity + "'" + (hint.empty() ? "" : "; " + hint));
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
        unknown(c, said);
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
