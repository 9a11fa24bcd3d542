#include <algorithm>
#include <cmath>
#include <map>

#include "scene/checker.h"
#include "scene/draw.h"
#include "scene/environments.h"
#include "scene/overrides.h"
#include "scene/quantity.h"
#include "scene/suggest.h"
#include "scene/vary_place.h"

namespace mortise::scene {
namespace {

class Check {
 public:
  Check(const Params& root, const ParamTable& table, Diagnostics& errors)
      : block_(root.at("environments")), root_(root), table_(table), errors_(errors) {}

  void entry(const Params& entry, const Node* node) {
    const Params* path = entry.find("path");
    if (!path) return;
    std::string way;
    const Params* how = way_of(entry, way);
    if (!how) {
      int ways = 0;
      for (const char* w : kWays) ways += entry.has(w);
      return errors_.add(entry.where(), "what is drawn for '" + path->as_text() + "' must be used in one way: scale, add or abs",
                         ways == 0 ? "for example scale: {log_uniform: [0.5, 2]}" : "");
    }
    if (const auto [first, fresh] = seen_.emplace(path->as_text(), path->where()); !fresh)
      return errors_.add(path->where(), "'" + path->as_text() + "' is varied twice", "", {{first->second, "first here"}});
    const Place place = find_place(*path, root_, table_, errors_);
    if (!place.found || how->entries().size() != 1) return;
    if (!place.value && way != "abs")
      return errors_.add(path->where(), path->as_text() + " is left to be chosen; there is no number to " + way + (way == "add" ? " to" : ""),
                         "write one in the scene, or use abs");
    if (way == "abs" && place.value && place.value->where().file.starts_with(kSet))
      return errors_.add(place.value->where(), path->as_text() + " is drawn for every environment, whatever is set", "",
                         {{path->where(), "drawn here, with abs"}});
    if (distribution(*how, way == "scale" ? Unit::none : place.param.unit, node ? node->find(way) : nullptr, way)) values(*path, *how, way, place);
  }

 private:
  // Ends in order, and numbers of the right kind: units were read as any so far.
  bool distribution(const Params& how, Unit unit, const Node* node, const std::string& way) {
    const auto& [name, numbers] = how.entries().front();
    const std::size_t before = count_;
    const Node* list = node ? node->find(name) : nullptr;
    for (std::size_t i = 0; list && i < list->items.size(); ++i) {
      const Quantity q = parse_quantity(list->items[i].text, unit);
      if (!q.error.empty()) fail(list->items[i].at, way + "." + name + " " + q.error, q.hint);
    }
    if (name == "choice") return count_ == before;
    if (numbers.items().size() != 2) {
      fail(numbers.where(), way + "." + name + " has " + std::to_string(numbers.items().size()) +
                                (numbers.items().size() == 1 ? " number" : " numbers") + "; must have two");
      return false;
    }
    const double a = numbers.items()[0].as_number(), b = numbers.items()[1].as_number();
    if (name == "normal" && b < 0) fail(numbers.where(), way + ".normal: the standard deviation is negative");
    if (name != "normal" && b < a) fail(numbers.where(), way + "." + name + ": the upper end is below the lower one");
    if (name == "log_uniform" && !(a > 0)) fail(numbers.where(), way + ".log_uniform: both ends must be positive");
    return count_ == before;
  }

  // All that may be drawn is in the parameter's range: the ends of what has some, and of a normal distribution every environment's.
  void values(const Params& path, const Params& how, const std::string& way, const Place& place) {
    const double base = place.value ? place.value->as_number() : 0;
    const auto fits = [&](double v) {
      const Param& p = place.param;
      return std::isfinite(v) && (p.min_open ? v > p.min : v >= p.min) && (p.max_open ? v < p.max : v <= p.max);
    };
    const std::string wanted = range_text(place.param);
    const auto& [name, numbers] = how.entries().front();
    if (name != "normal") {
      for (const Params& end : numbers.items())
        if (const double v = combined(way, base, end.as_number()); !fits(v))
          return errors_.add(end.where(), path.as_text() + " becomes " + format_number(v) + "; must be " + (wanted.empty() ? "finite" : wanted));
      return;
    }
    for (long e = 0; e < block_.integer("count"); ++e)
      if (const double v = combined(way, base, drawn_from(how, chance(block_, path.as_text(), e, 0))); !fits(v))
        return errors_.add(numbers.where(),
                           path.as_text() + " becomes " + format_number(v) + " in environment " + std::to_string(e) + "; must be " +
                               (wanted.empty() ? "finite" : wanted),
                           "a smaller deviation, or uniform, stays in the range");
  }

  void fail(const SourceLoc& at, const std::string& what, const std::string& hint = "") {
    ++count_;
    errors_.add(at, what, hint);
  }

  const Params &block_, &root_;
  const ParamTable& table_;
  Diagnostics& errors_;
  std::map<std::string, SourceLoc> seen_;
  std::size_t count_ = 0;  // of errors in distributions
};

void check_reset(const Params& entry, const Node* node, const Params* bodies, Diagnostics& errors) {
  int what = 0;
  for (const char* key : {"after", "body", "quantity", "failure"}) what += entry.has(key);
  if (what != 1) return errors.add(entry.where(), "a reset hangs on exactly one of after, body, quantity and failure");
  const Params *body = entry.find("body"), *quantity = entry.find("quantity"), *failure = entry.find("failure");
  const bool bounded = entry.has("above") || entry.has("below");
  if ((body || quantity) && !bounded)
    errors.add(entry.where(), "a reset by " + std::string(body ? "a body's place" : "a quantity") + " needs 'above' or 'below'");
  if (!body && !quantity && bounded) errors.add(entry.where(), "'above' and 'below' belong to a body or a quantity");
  if (entry.has("above") && entry.has("below") && entry.number("above") < entry.number("below"))
    errors.add(entry.where(), "every value is above 'above' or below 'below'", "an episode ends where either is met: below comes first");
  if (!body && entry.has("axis")) errors.add(entry.at("axis").where(), "'axis' belongs to a body");
  if (body && !entry.has("axis")) errors.add(entry.where(), "a reset by a body's place needs 'axis'");
  if (failure && !failure->as_flag()) errors.add(failure->where(), "failure: false has no meaning", "leave the entry out");
  if (body && bodies) {
    const Params* found = bodies->find(body->as_text());
    if (!found) errors.add(body->where(), "no body '" + body->as_text() + "'", suggestion(body->as_text(), keys_of(*bodies)));
    if (found && found->text("type") == "half_space") errors.add(body->where(), "half-space '" + body->as_text() + "' does not move");
    for (const char* key : {"above", "below"})
      if (const Node* bound = node ? node->find(key) : nullptr)
        if (const Quantity q = parse_quantity(bound->text, Unit::length); !q.error.empty())
          errors.add(bound->at, std::string(key) + " " + q.error, q.hint);
  }
  if (quantity && (quantity->as_text().find('/') == std::string::npos || quantity->as_text().back() == '/'))
    errors.add(quantity->where(), "'" + quantity->as_text() + "' is no scalar", "write group/name, as in fields.vtkhdf under mortise/effects");
}

const Node* entry_of(const Node* list, std::size_t i) {
  return !list ? nullptr : list->kind != Node::Kind::list ? list : i < list->items.size() ? &list->items[i] : nullptr;
}

}  // namespace

void check_environments(const Node& written, const Params& root, const ParamTable& table, const std::set<std::string>& incomplete,
                        Diagnostics& errors) {
  const Params* block = root.find("environments");
  // Where the rest is wrong, paths into it may not lead anywhere.
  const bool whole = std::all_of(incomplete.begin(), incomplete.end(), [](const std::string& path) { return path.rfind("environments", 0) == 0; });
  if (!block || !block->has("count") || !block->has("seed") || !whole || incomplete.count("environments")) return;
  const Node* environments = written.find("environments");
  Check check(root, table, errors);
  if (const Params* vary = block->find("vary"))
    for (std::size_t i = 0; i < vary->items().size(); ++i)
      if (!incomplete.count("environments.vary." + std::to_string(i)))
        check.entry(vary->items()[i], entry_of(environments ? environments->find("vary") : nullptr, i));
  if (const Params* reset = block->find("reset"))
    for (std::size_t i = 0; i < reset->items().size(); ++i)
      if (!incomplete.count("environments.reset." + std::to_string(i)))
        check_reset(reset->items()[i], entry_of(environments ? environments->find("reset") : nullptr, i), root.find("bodies"), errors);
}

}  // namespace mortise::scene
