#include "scene/environments.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/philox.h"
#include "scene/checker.h"
#include "scene/distribution.h"
#include "scene/quantity.h"
#include "scene/suggest.h"
#include "scene/tables.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
using namespace param;

constexpr const char* kWays[] = {"scale", "add", "abs"};

const ParamTable& distribution_table() {
  static const ParamTable t = [] {
    const auto numbers = [](const char* key, const char* help) { return optional(of(Kind::numbers, key, Unit::any, {}, help)); };
    ParamTable d{"distribution",
                 "What a number is drawn from: exactly one of these.",
                 {numbers("uniform", "Lower and upper end, all in between equally probable."), numbers("log_uniform", "Lower and upper end, both positive; its logarithm is equally probable everywhere in between."),
                  numbers("normal", "Mean and standard deviation."), numbers("choice", "Values, all equally probable.")}};
    d.one_of = true;
    return d;
  }();
  return t;
}

const ParamTable& vary_table() {
  static const ParamTable t{"vary",
                            "One number of the scene that differs between environments: its path, and exactly one of scale, add and abs.",
                            {required(of(Kind::text, "path", Unit::none, {}, "The number, as --set names it: materials.gel.youngs_modulus, bodies.ball.position.0.")),
                             table("scale", &distribution_table(), "The scene's number times what is drawn."), table("add", &distribution_table(), "The scene's number plus what is drawn."),
                             table("abs", &distribution_table(), "What is drawn, in the place of the scene's number.")}};
  return t;
}

const ParamTable& reset_table() {
  static const ParamTable t{"reset",
                            "When an environment begins its next episode: exactly one of after, body, quantity and failure.",
                            {positive(optional(of(Kind::number, "after", Unit::time, {}, "Time in the episode."))),
                             optional(of(Kind::text, "body", Unit::none, {}, "Body whose centre of mass leaves what `above` and `below` leave it.")),
                             optional(choice("axis", {"x", "y", "z"}, "", "Of the body's centre: which coordinate.")),
                             optional(of(Kind::text, "quantity", Unit::none, {}, "Scalar that an effect reports, as group/name: mortar_contact/force_pad_z.")),
                             optional(of(Kind::number, "above", Unit::any, {}, "The episode ends where the number is larger than this.")),
                             optional(of(Kind::number, "below", Unit::any, {}, "The episode ends where the number is smaller than this.")),
                             optional(of(Kind::flag, "failure", Unit::none, {}, "true: a step that fails, or bodies that touch at the start, end the episode and not the environment."))}};
  return t;
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts{""};
  for (char c : path)
    if (c == '.') parts.emplace_back();
    else parts.back() += c;
  return parts;
}

const ParamTable& table_of(const ParamTable& base, const Params& block) {
  if (const Variants* variants = variants_of(base))
    for (const auto& [name, table] : variants->of)
      if (const Params* key = block.find(variants->key); key && key->as_text() == name) return *table;
  return base;
}

std::vector<std::string> keys(const Params& block) {
  std::vector<std::string> out;
  for (const auto& [key, value] : block.entries()) out.push_back(key);
  return out;
}

// Blocks of which every environment has the same.
std::string common(const std::string& block) {
  static const std::map<std::string, std::string> why{{"time", "all environments take the same steps"},
                                                      {"solver", "all environments are solved to the same tolerances"},
                                                      {"output", "all environments write the same files"},
                                                      {"render", "all environments are seen by the same cameras"},
                                                      {"checks", "all environments are judged by the same checks"},
                                                      {"pairs", "all environments have the same pairs"},
                                                      {"environments", "the block says how environments differ"}};
  const auto it = why.find(block);
  return it == why.end() ? "" : it->second;
}

// What a path names: its parameter, and its number in the scene where it has one.
struct Place {
  Param param;
  const Params* value = nullptr;
  bool found = false;
};

class Vary {
 public:
  Vary(const Params& root, const ParamTable& table, Diagnostics& errors) : root_(root), table_(table), errors_(errors) {}

  Place find(const Params& cited) const {
    Place here{param::table("", &table_, ""), &root_};
    std::string path;
    for (const std::string& part : split(cited.as_text())) {
      if (path.empty())
        if (const std::string why = common(part); !why.empty()) return fail(cited, "'" + part + "' cannot differ between environments: " + why, part == "environments" ? "" : "a sweep can vary it: mortise sweep");
      if (here.value && here.value->kind() == Params::Kind::list) {
        if (!item(here, part, path, cited)) return {};
      } else if (here.param.kind == Kind::map && here.value) {
        const Params* child = here.value->find(part);
        if (!child) return fail(cited, "the scene has no '" + part + "' under " + path, suggestion(part, keys(*here.value)));
        here.param.kind = Kind::table, here.value = child;
      } else if (here.param.kind == Kind::table && here.value) {
        if (!key(here, part, path, cited)) return {};
      } else if (here.param.kind == Kind::schedule && here.value && here.value->kind() == Params::Kind::table) {
        const Params* child = here.value->find(part);
        if (!child) return fail(cited, "unknown key '" + part + "' in " + path, suggestion(part, keys(*here.value)));
        if (part == "time") here.param.unit = Unit::time;
        here.param.kind = Kind::numbers, here.value = child;
      } else {
        return fail(cited, path + (here.value ? " is a single value; it has no '" + part + "'" : " is not written in the scene"), "");
      }
      path = dotted(path, part);
      if (path.rfind("bodies.", 0) == 0 && part == "shape") return fail(cited, path + " cannot differ between environments: all have the same meshes", "a sweep can vary it: mortise sweep");
    }
    return number(here, path, cited);
  }

 private:
  Place fail(const Params& cited, const std::string& what, const std::string& hint) const {
    errors_.add(cited.where(), what, hint);
    return {};
  }
  bool item(Place& here, const std::string& part, const std::string& path, const Params& cited) const {
    const std::size_t n = here.value->items().size();
    const bool digits = !part.empty() && part.size() < 7 && part.find_first_not_of("0123456789") == std::string::npos;
    if (!digits || std::stoul(part) >= n) {
      fail(cited, path + " is a list; its entries are named 0" + (n > 1 ? " to " + std::to_string(n - 1) : ""), digits ? "" : "write " + path + ".0." + part);
      return false;
    }
    here.value = &here.value->items()[std::stoul(part)];
    if (here.param.kind == Kind::tables) here.param.kind = Kind::table;
    else if (here.param.kind == Kind::vec3s) here.param.kind = Kind::vec3;
    else if (here.param.kind == Kind::vec3 || here.param.kind == Kind::numbers) here.param.kind = Kind::number;
    else here.param.kind = Kind::text;
    return true;
  }
  bool key(Place& here, const std::string& part, const std::string& path, const Params& cited) const {
    const ParamTable& block = table_of(*here.param.sub, *here.value);
    const auto p = std::find_if(block.params.begin(), block.params.end(), [&](const Param& q) { return q.key == part; });
    if (p == block.params.end()) {
      std::vector<std::string> known;
      for (const Param& q : block.params) known.push_back(q.key);
      fail(cited, "unknown key '" + part + "' in " + (path.empty() ? "the scene" : path), suggestion(part, known));
      return false;
    }
    const Params* child = here.value->find(part);
    if (path == "effects" && !child) {
      fail(cited, "the scene does not list the effect '" + part + "'", suggestion(part, keys(*here.value)));
      return false;
    }
    here.param = *p, here.value = child;
    return true;
  }
  Place number(Place here, const std::string& path, const Params& cited) const {
    if (here.param.kind == Kind::integer) return fail(cited, path + " is a whole number, of which all environments have the same", "only numbers that measure something can differ");
    if (here.param.kind == Kind::schedule && (!here.value || here.value->kind() != Params::Kind::table)) here.param.kind = Kind::number;
    if (here.param.kind == Kind::number) return here.found = true, here;
    if (here.value && here.value->kind() == Params::Kind::list && !here.value->items().empty()) return fail(cited, path + " is a list; name one of its numbers", "write " + path + ".0");
    if (here.value && here.value->kind() == Params::Kind::table) return fail(cited, path + " is a block; name one of its numbers", "it has " + join(keys(*here.value), ", "));
    return fail(cited, path + " is no number", "only numbers can differ between environments");
  }

  const Params& root_;
  const ParamTable& table_;
  Diagnostics& errors_;
};

// scale, add or abs; null where the entry has none or several.
const Params* way_of(const Params& entry, std::string& name) {
  const Params* found = nullptr;
  for (const char* way : kWays)
    if (const Params* d = entry.find(way)) {
      if (found) return nullptr;
      found = d, name = way;
    }
  return found;
}

Distribution distribution_of(const Params& written) {
  static const std::map<std::string, Distribution::Kind> kinds{
      {"uniform", Distribution::Kind::uniform}, {"log_uniform", Distribution::Kind::log_uniform}, {"normal", Distribution::Kind::normal}, {"choice", Distribution::Kind::choice}};
  const auto& [name, numbers] = written.entries().front();
  Distribution out;
  out.kind = kinds.at(name);
  if (out.kind != Distribution::Kind::choice) out.a = numbers.items()[0].as_number(), out.b = numbers.items()[1].as_number();
  return out;
}

double drawn_from(const Params& written, double u) {
  const Distribution d = distribution_of(written);
  if (d.kind != Distribution::Kind::choice) return d.number(u);
  const std::vector<double> values = written.entries().front().second.as_numbers();
  return values[Distribution::one_of(u, values.size())];
}

double combined(const std::string& way, double base, double drawn) { return way == "scale" ? base * drawn : way == "add" ? base + drawn : drawn; }

// The number at a path that was checked; null where the scene leaves it to be chosen.
const Params* at_path(const Params& root, const std::string& path) {
  const Params* here = &root;
  for (const std::string& part : split(path)) {
    here = here->kind() == Params::Kind::list ? &here->items().at(std::stoul(part)) : here->find(part);
    if (!here) return nullptr;
  }
  return here;
}

// One draw: its index has room for 2^32 environments and as many episodes.
double chance(const Params& block, const std::string& path, long environment, long episode) {
  const Stream stream(static_cast<std::uint64_t>(block.integer("seed")), path);
  return stream.at(static_cast<std::uint64_t>(environment) | static_cast<std::uint64_t>(episode) << 32)[0];
}

class Check {
 public:
  Check(const Params& root, const ParamTable& table, Diagnostics& errors) : block_(root.at("environments")), vary_(root, table, errors), errors_(errors) {}

  void entry(const Params& entry, const Node* node) {
    const Params* path = entry.find("path");
    if (!path) return;
    std::string way;
    const Params* how = way_of(entry, way);
    if (!how) {
      int ways = 0;
      for (const char* w : kWays) ways += entry.has(w);
      return errors_.add(entry.where(), "what is drawn for '" + path->as_text() + "' must be used in one way: scale, add or abs", ways == 0 ? "for example scale: {log_uniform: [0.5, 2]}" : "");
    }
    if (const auto [first, fresh] = seen_.emplace(path->as_text(), path->where()); !fresh)
      return errors_.add(path->where(), "'" + path->as_text() + "' is varied twice", "", {{first->second, "first here"}});
    const Place place = vary_.find(*path);
    if (!place.found || how->entries().size() != 1) return;
    if (!place.value && way != "abs") return errors_.add(path->where(), path->as_text() + " is left to be chosen; there is no number to " + way + (way == "add" ? " to" : ""), "write one in the scene, or use abs");
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
      fail(numbers.where(), way + "." + name + " has " + std::to_string(numbers.items().size()) + (numbers.items().size() == 1 ? " number" : " numbers") + "; must have two");
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
        return errors_.add(numbers.where(), path.as_text() + " becomes " + format_number(v) + " in environment " + std::to_string(e) + "; must be " + (wanted.empty() ? "finite" : wanted), "a smaller deviation, or uniform, stays in the range");
  }

  void fail(const SourceLoc& at, const std::string& what, const std::string& hint = "") {
    ++count_;
    errors_.add(at, what, hint);
  }

  const Params& block_;
  Vary vary_;
  Diagnostics& errors_;
  std::map<std::string, SourceLoc> seen_;
  std::size_t count_ = 0;  // of errors in distributions
};

}  // namespace

const ParamTable& environments_table() {
  static const ParamTable t = [] {
    Param vary = table("vary", &vary_table(), "Numbers that differ between environments; without any all are equal.");
    vary.kind = Kind::tables;
    Param reset = table("reset", &reset_table(), "Conditions that end an episode. The next begins at the start, with new numbers; time.steps are the steps of all episodes of an environment.");
    reset.kind = Kind::tables;
    return ParamTable{"environments",
                      "Copies of the scene that are run side by side and know nothing of each other, each with numbers of its own.",
                      {range(of(Kind::integer, "count", Unit::none, {}, "How many there are."), 1, 1e6),
                       range(of(Kind::integer, "seed", Unit::none, "0", "What is drawn hangs on this number, the environment and the path, and on nothing else."), 0, 9007199254740992.0), vary,
                       choice("pictures", {"none", "first", "all", "grid"}, "first", "Which environments draw pictures; grid: all, and side by side in one picture each."), reset}};
  }();
  return t;
}

namespace {

void check_reset(const Params& entry, const Node* node, const Params* bodies, Diagnostics& errors) {
  int what = 0;
  for (const char* key : {"after", "body", "quantity", "failure"}) what += entry.has(key);
  if (what != 1) return errors.add(entry.where(), "a reset hangs on exactly one of after, body, quantity and failure");
  const Params *body = entry.find("body"), *quantity = entry.find("quantity"), *failure = entry.find("failure");
  const bool bounded = entry.has("above") || entry.has("below");
  if ((body || quantity) && !bounded) errors.add(entry.where(), "a reset by " + std::string(body ? "a body's place" : "a quantity") + " needs 'above' or 'below'");
  if (!body && !quantity && bounded) errors.add(entry.where(), "'above' and 'below' belong to a body or a quantity");
  if (!body && entry.has("axis")) errors.add(entry.at("axis").where(), "'axis' belongs to a body");
  if (body && !entry.has("axis")) errors.add(entry.where(), "a reset by a body's place needs 'axis'");
  if (failure && !failure->as_flag()) errors.add(failure->where(), "failure: false has no meaning", "leave the entry out");
  if (body && bodies) {
    const Params* found = bodies->find(body->as_text());
    if (!found) errors.add(body->where(), "no body '" + body->as_text() + "'", suggestion(body->as_text(), keys(*bodies)));
    if (found && found->text("type") == "half_space") errors.add(body->where(), "half-space '" + body->as_text() + "' does not move");
    for (const char* key : {"above", "below"})
      if (const Node* bound = node ? node->find(key) : nullptr)
        if (const Quantity q = parse_quantity(bound->text, Unit::length); !q.error.empty()) errors.add(bound->at, std::string(key) + " " + q.error, q.hint);
  }
  if (quantity && (quantity->as_text().find('/') == std::string::npos || quantity->as_text().back() == '/'))
    errors.add(quantity->where(), "'" + quantity->as_text() + "' is no scalar", "write group/name, as in fields.vtkhdf under mortise/effects");
}

const Node* entry_of(const Node* list, std::size_t i) { return !list ? nullptr : list->kind != Node::Kind::list ? list : i < list->items.size() ? &list->items[i] : nullptr; }

}  // namespace

void check_environments(const Node& written, const Params& root, const ParamTable& table, const std::set<std::string>& incomplete, Diagnostics& errors) {
  const Params* block = root.find("environments");
  // Where the rest is wrong, paths into it may not lead anywhere.
  const bool whole = std::all_of(incomplete.begin(), incomplete.end(), [](const std::string& path) { return path.rfind("environments", 0) == 0; });
  if (!block || !block->has("count") || !block->has("seed") || !whole || incomplete.count("environments")) return;
  const Node* environments = written.find("environments");
  Check check(root, table, errors);
  if (const Params* vary = block->find("vary"))
    for (std::size_t i = 0; i < vary->items().size(); ++i)
      if (!incomplete.count("environments.vary." + std::to_string(i))) check.entry(vary->items()[i], entry_of(environments ? environments->find("vary") : nullptr, i));
  if (const Params* reset = block->find("reset"))
    for (std::size_t i = 0; i < reset->items().size(); ++i)
      if (!incomplete.count("environments.reset." + std::to_string(i))) check_reset(reset->items()[i], entry_of(environments ? environments->find("reset") : nullptr, i), root.find("bodies"), errors);
}

long environment_count(const Params& root) {
  const Params* block = root.find("environments");
  return block ? static_cast<long>(block->integer("count")) : 0;
}

std::vector<Drawn> draw(const Params& root, long environment, long episode) {
  std::vector<Drawn> out;
  const Params& block = root.at("environments");
  const Params* vary = block.find("vary");
  for (std::size_t i = 0; vary && i < vary->items().size(); ++i) {
    const Params& entry = vary->items()[i];
    const std::string& path = entry.text("path");
    std::string way;
    const Params& how = *way_of(entry, way);
    const Params* base = at_path(root, path);
    const double drawn = drawn_from(how, chance(block, path, environment, episode));
    out.push_back({path, drawn, combined(way, base ? base->as_number() : 0, drawn)});
  }
  return out;
}

}  // namespace mortise::scene
