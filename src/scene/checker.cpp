#include "scene/checker.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "scene/quantity.h"
#include "scene/suggest.h"
#include "scene/tables.h"

namespace mortise::scene {
namespace {

using Kind = Param::Kind;
namespace fs = std::filesystem;

std::string unit_in_brackets(const Param& p) {
  const std::string symbol = si_symbol(p.unit);
  return symbol.empty() ? "" : "[" + symbol + "] ";
}

}  // namespace

std::string dotted(const std::string& path, const std::string& key) { return path.empty() ? key : path + "." + key; }

bool is_private_key(const std::string& key) { return key.rfind("x-", 0) == 0; }

bool is_name(const std::string& s) {
  return !s.empty() &&
         std::all_of(s.begin(), s.end(), [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-'; });
}

std::string range_text(const Param& p) {
  const std::string symbol = si_symbol(p.unit), unit = symbol.empty() ? "" : " " + symbol;
  const bool lower = std::isfinite(p.min), upper = std::isfinite(p.max);
  if (lower && upper)
    return "in " + std::string(p.min_open ? "(" : "[") + format_number(p.min) + ", " + format_number(p.max) + (p.max_open ? ")" : "]") + unit;
  if (lower) return (p.min_open ? "> " : ">= ") + format_number(p.min) + unit;
  if (upper) return (p.max_open ? "< " : "<= ") + format_number(p.max) + unit;
  return "";
}

Params Checker::table(const ParamTable& base, const Node& node, const std::string& path) {
  Params out = Params::make_table(node.key_at);
  const std::string where = path.empty() ? "the scene" : path;
  if (node.kind != Node::Kind::map && node.kind != Node::Kind::null) {
    std::vector<std::string> keys;
    for (const Param& p : base.params) keys.push_back(p.key + ": ...");
    std::string hint = keys.size() > 4 ? "" : "{" + join(keys, ", ") + "}";
    for (const Param& p : base.params)  // `where: all`
      if (node.kind == Node::Kind::scalar && std::count(p.choices.begin(), p.choices.end(), node.text)) hint = "{" + p.key + ": " + node.text + "}";
    errors_.add(node.at, where + " is " + node.describe() + "; must be a block of keys", hint);
    incomplete_.insert(path);
    return out;
  }

  // A body's keys depend on its type.
  const ParamTable* t = &base;
  if (const Variants* variants = variants_of(base)) {
    const Node* key = node.find(variants->key);
    for (const auto& [name, table] : variants->of)
      if (key && key->kind == Node::Kind::scalar && key->text == name) t = table;
    if (t == &base) {  // nothing else can be judged
      if (!key)
        errors_.add(node.key_at, where + " has no '" + variants->key + "'", "one of: " + join(base.params.front().choices, ", "));
      else
        value(base.params.front(), *key, dotted(path, variants->key));
      return out;
    }
  }

  std::vector<std::string> known;
  for (const Param& p : t->params) known.push_back(p.key);
  std::vector<std::string> free;  // what is already written is not what another key means
  for (const std::string& k : known)
    if (!node.find(k)) free.push_back(k);
  std::map<std::string, const Node*> written;
  std::set<std::string> meant;
  for (const auto& [key, child] : node.entries) {
    if (is_private_key(key)) continue;
    if (const auto [first, fresh] = written.try_emplace(key, &child); !fresh) {
      errors_.add(child.key_at, "'" + key + "' appears twice in " + where, "", {{first->second->key_at, "the first one"}});
      continue;
    }
    const auto p = std::find_if(t->params.begin(), t->params.end(), [&](const Param& q) { return q.key == key; });
    if (p == t->params.end()) {
      const std::string best = nearest(key, free);
      meant.insert(best);
      incomplete_.insert(path);
      std::string hint = suggestion(key, best.empty() ? known : free);
      for (const Param& block : t->params) {  // a key of one of the blocks in here, one level too far out
        if (!best.empty() || block.kind != Kind::table) continue;
        const auto holds = [&](const Param& q) { return q.key == key; };
        if (std::none_of(block.sub->params.begin(), block.sub->params.end(), holds)) continue;
        hint = "it belongs in '" + block.key + "'";
        meant.insert(block.key);
      }
      if (hint.empty() && path.rfind("effects", 0) == 0) {
        const std::string effect = path.substr(0, path.find('.', 8));  // "effects.friction"
        hint = "'mortise effects" + (effect.size() > 8 ? " " + effect.substr(8) : "") + "' lists all";
      }
      errors_.add(child.key_at, (path == "effects" ? "unknown effect '" + key + "'" : "unknown key '" + key + "' in " + where), hint);
      continue;
    }
    if (p->automatic && child.kind == Node::Kind::scalar && child.text == "auto") continue;
    if (p->optional && child.kind == Node::Kind::null && p->kind != Kind::table && p->kind != Kind::tables) {
      errors_.add(child.key_at, dotted(path, key) + " is empty", "give it a value or remove the key");
      continue;
    }
    if (std::optional<Params> v = value(*p, child, dotted(path, key)))
      out.set(key, std::move(*v));
    else
      incomplete_.insert(path);
  }

  // Defaults, and what must be there.
  for (const Param& p : t->params) {
    if (written.count(p.key)) continue;
    if (p.fallback) {
      const Node fallback = parse_yaml(*p.fallback, "", &node.key_at);
      if (std::optional<Params> v = value(p, fallback, dotted(path, p.key))) out.set(p.key, std::move(*v));
    } else if (!p.optional && !meant.count(p.key)) {
      errors_.add(node.key_at, where + " has no '" + p.key + "'", unit_in_brackets(p) + p.help);
    }
  }
  if (t->one_of) one_of(*t, node, path);
  times(*t, out, path);
  return out;
}

// Exactly one key of the table is written.
void Checker::one_of(const ParamTable& t, const Node& node, const std::string& path) {
  std::vector<const Node*> found;
  std::vector<std::string> known, names;
  for (const Param& p : t.params) known.push_back(p.key);
  for (const auto& [key, child] : node.entries)
    if (std::find(known.begin(), known.end(), key) != known.end()) found.push_back(&child), names.push_back(key);
  if (found.empty() && !incomplete_.count(path)) errors_.add(node.key_at, path + " must hold one of: " + join(known, ", "));
  if (found.size() > 1)
    errors_.add(found[1]->key_at, path + " must hold only one of: " + join(names, ", "), "", {{found[0]->key_at, "the first one"}});
}

// A list called `time` must increase, and every other list of the block belongs to it entry by entry.
void Checker::times(const ParamTable& t, const Params& block, const std::string& path) {
  const auto p = std::find_if(t.params.begin(), t.params.end(), [](const Param& q) { return q.key == "time" && q.kind == Kind::numbers; });
  const Params* time = block.find("time");
  if (p == t.params.end() || !time) return;
  const std::vector<Params>& items = time->items();
  for (std::size_t i = 1; i < items.size(); ++i)
    if (!(items[i].as_number() > items[i - 1].as_number())) {
      errors_.add(items[i].where(), dotted(path, "time") + " must increase from entry to entry");
      break;
    }
  lengths(t, block, items.size(), dotted(path, "time"), path);
}

void Checker::lengths(const ParamTable& t, const Params& block, std::size_t wanted, const std::string& time_path, const std::string& path) {
  for (const Param& p : t.params) {
    const Params* v = block.find(p.key);
    if (!v || p.key == "time") continue;
    if (p.kind == Kind::table) {
      lengths(*p.sub, *v, wanted, time_path, dotted(path, p.key));
    } else if ((p.kind == Kind::numbers || p.kind == Kind::vec3s) && v->items().size() != wanted) {
      errors_.add(v->where(), dotted(path, p.key) + " has " + std::to_string(v->items().size()) + " entries, " + time_path + " has " +
                                  std::to_string(wanted) + "; they must match");
    }
  }
}

std::optional<Params> Checker::value(const Param& p, const Node& n, const std::string& path) {
  switch (p.kind) {
    case Kind::number:
      return number(p, n, path);
    case Kind::integer:
      return integer(p, n, path);
    case Kind::flag:
      return flag(n, path);
    case Kind::text:
      return text(p, n, path);
    case Kind::path:
      return file(n, path);
    case Kind::choice:
      return choice(p, n, path);
    case Kind::schedule:
      return schedule(p, n, path);
    case Kind::table:
      return table(*p.sub, n, path);
    case Kind::map:
      return map(p, n, path);
    case Kind::vec3:
    case Kind::numbers:
    case Kind::vec3s:
    case Kind::names:
    case Kind::pairs:
    case Kind::tables:
      return list(p, n, path);
  }
  return {};
}

std::optional<Params> Checker::in_range(const Param& p, double v, const Node& n, const std::string& path, Params result) {
  const bool low = p.min_open ? v > p.min : v >= p.min, high = p.max_open ? v < p.max : v <= p.max;
  if (low && high) return result;
  errors_.add(n.at, path + " is " + n.text + "; must be " + range_text(p));
  return {};
}

std::optional<Params> Checker::number(const Param& p, const Node& n, const std::string& path) {
  const std::string wanted = p.unit == Unit::none || p.unit == Unit::any ? "a number" : "a number [" + std::string(si_symbol(p.unit)) + "]";
  if (n.kind != Node::Kind::scalar ||
      !(looks_like_quantity(n.text) || (n.text.size() < 12 && n.text.find_first_not_of("+-.infatyINFATY") == std::string::npos))) {
    errors_.add(n.at, path + " is " + n.describe() + "; must be " + wanted);
    return {};
  }
  const Quantity q = parse_quantity(n.text, p.unit);
  if (!q.error.empty()) {
    errors_.add(n.at, path + " " + q.error, q.hint);
    return {};
  }
  // "0.5 mm" may stand in quotes; a number without unit in quotes is text.
  if (n.quoted && n.text.find_first_not_of("+-.0123456789eE") == std::string::npos) {
    errors_.add(n.at, path + " is " + n.describe() + "; must be " + wanted, "write it without quotes");
    return {};
  }
  return in_range(p, q.value, n, path, Params::make_number(q.value, n.at));
}

std::optional<Params> Checker::integer(const Param& p, const Node& n, const std::string& path) {
  if (n.kind != Node::Kind::scalar || n.quoted || !looks_like_quantity(n.text)) {
    errors_.add(n.at, path + " is " + n.describe() + "; must be a whole number", n.quoted ? "write it without quotes" : "");
    return {};
  }
  const Quantity q = parse_quantity(n.text, Unit::none);
  if (!q.error.empty()) {
    errors_.add(n.at, path + " " + q.error, q.hint);
    return {};
  }
  if (q.value != std::floor(q.value) || std::abs(q.value) > 9007199254740992.0) {  // 2^53: above it doubles skip whole numbers
    errors_.add(n.at, path + " is " + n.text + "; must be a whole number");
    return {};
  }
  return in_range(p, q.value, n, path, Params::make_integer(static_cast<long long>(q.value), n.at));
}

std::optional<Params> Checker::flag(const Node& n, const std::string& path) {
  if (n.kind == Node::Kind::scalar && !n.quoted && (n.text == "true" || n.text == "false")) return Params::make_flag(n.text == "true", n.at);
  errors_.add(n.at, path + " is " + n.describe() + "; must be true or false");
  return {};
}

std::optional<Params> Checker::text(const Param& p, const Node& n, const std::string& path) {
  if (n.kind == Node::Kind::scalar && (!n.text.empty() || p.fallback)) return Params::make_text(n.text, n.at);
  errors_.add(n.at, path + " is " + (n.kind == Node::Kind::scalar ? "empty" : n.describe()) + "; must be text");
  return {};
}

std::optional<Params> Checker::choice(const Param& p, const Node& n, const std::string& path) {
  if (n.kind == Node::Kind::scalar && std::find(p.choices.begin(), p.choices.end(), n.text) != p.choices.end())
    return Params::make_text(n.text, n.at);
  const std::string best = n.kind == Node::Kind::scalar ? nearest(n.text, p.choices) : "";
  errors_.add(n.at, path + " is " + n.describe() + "; must be one of: " + join(p.choices, ", "), best.empty() ? "" : "did you mean '" + best + "'?");
  return {};
}

std::optional<Params> Checker::file(const Node& n, const std::string& path) {
  if (n.kind != Node::Kind::scalar || n.text.empty()) {
    errors_.add(n.at, path + " is " + (n.kind == Node::Kind::scalar ? "empty" : n.describe()) + "; must be the path of a file");
    return {};
  }
  const fs::path full = (fs::path(folder_) / n.text).lexically_normal();
  std::error_code ignored;
  if (fs::is_regular_file(full, ignored)) return Params::make_path(full.string(), n.at);
  std::string hint = "relative paths start at the scene's folder";
  if (fs::is_directory(full, ignored)) {
    errors_.add(n.at, path + ": '" + n.text + "' is a folder, not a file");
    return {};
  }
  if (fs::exists(full, ignored)) {
    errors_.add(n.at, path + ": '" + n.text + "' is no regular file");
    return {};
  }
  std::vector<std::string> beside;
  for (fs::directory_iterator it(full.parent_path(), ignored), end; !ignored && it != end; it.increment(ignored))
    beside.push_back((fs::path(n.text).parent_path() / it->path().filename()).string());
  std::sort(beside.begin(), beside.end());
  if (const std::string best = nearest(n.text, beside); !best.empty()) hint = "did you mean '" + best + "'?";
  errors_.add(n.at, path + ": no file '" + n.text + "'", hint);
  return {};
}

std::optional<Params> Checker::schedule(const Param& p, const Node& n, const std::string& path) {
  Param item = p;
  if (n.kind != Node::Kind::map) {
    if (n.kind == Node::Kind::scalar) return number(item, n, path);
    errors_.add(n.at, path + " is " + n.describe() + "; must be a number or {time: [...], value: [...]}");
    return {};
  }
  Param time = param::of(Kind::numbers, "time", Unit::time, {}, "times, increasing");
  item.key = "value", item.kind = Kind::numbers, item.fallback.reset(), item.optional = false, item.help = "one value per time";
  const ParamTable t{"schedule", "", {time, item}};
  return table(t, n, path);
}

std::optional<Params> Checker::list(const Param& p, const Node& n, const std::string& path) {
  const Kind kind = p.kind;
  // A single block stands for a list of one.
  if (kind == Kind::tables && (n.kind == Node::Kind::map || n.kind == Node::Kind::null)) {
    Params one = Params::make_list({}, n.key_at);
    one.push(table(*p.sub, n, path));
    return one;
  }
  const char* wanted = kind == Kind::vec3      ? "a list of 3 numbers"
                       : kind == Kind::numbers ? "a list of numbers"
                       : kind == Kind::vec3s   ? "a list of [x, y, z] lists"
                       : kind == Kind::names   ? "a list of names"
                       : kind == Kind::pairs   ? "a list of [name, name] pairs"
                                               : "a list of blocks";
  if (n.kind != Node::Kind::list) {
    errors_.add(n.at, path + " is " + n.describe() + "; must be " + wanted);
    return {};
  }
  if (kind == Kind::vec3 && n.items.size() != 3) {
    errors_.add(n.at, path + " has " + std::to_string(n.items.size()) + " entries; must be " + wanted);
    return {};
  }
  if (n.items.empty() && ((kind != Kind::names && kind != Kind::pairs) || !p.choices.empty())) {
    errors_.add(n.at, path + " is an empty list");
    return {};
  }
  Param item = p;
  if (kind == Kind::vec3s) item.kind = Kind::vec3;
  if (kind == Kind::tables) item.kind = Kind::table;
  if (kind == Kind::vec3 || kind == Kind::numbers) item.kind = Kind::number;
  if (kind == Kind::names) item.kind = p.choices.empty() ? Kind::text : Kind::choice;
  if (kind == Kind::pairs) item.kind = Kind::names;

  Params out = Params::make_list({}, kind == Kind::tables ? n.key_at : n.at);
  bool good = true;
  for (std::size_t i = 0; i < n.items.size(); ++i) {
    const std::string item_path = dotted(path, std::to_string(i));
    if (kind == Kind::pairs && n.items[i].kind == Node::Kind::list && n.items[i].items.size() != 2) {
      errors_.add(n.items[i].at, item_path + " has " + std::to_string(n.items[i].items.size()) + " entries; must be [name, name]");
      good = false;
      continue;
    }
    std::optional<Params> v = value(item, n.items[i], item_path);
    good = good && v;
    if (v) out.push(std::move(*v));
  }
  if (!good) return {};
  return out;
}

Params Checker::map(const Param& p, const Node& n, const std::string& path) {
  Params out = Params::make_table(n.key_at);
  if (n.kind != Node::Kind::map && n.kind != Node::Kind::null) {
    errors_.add(n.at, path + " is " + n.describe() + "; must be a block of named blocks");
    return out;
  }
  std::map<std::string, const Node*> written;
  for (const auto& [key, child] : n.entries) {
    if (is_private_key(key)) continue;
    if (const auto [first, fresh] = written.try_emplace(key, &child); !fresh) {
      errors_.add(child.key_at, "'" + key + "' appears twice in " + path, "", {{first->second->key_at, "the first one"}});
      continue;
    }
    if (!is_name(key)) errors_.add(child.key_at, "'" + key + "' is not a name; names are made of a-z, 0-9, _ and -");
    out.set(key, table(*p.sub, child, dotted(path, key)));
  }
  return out;
}

}  // namespace mortise::scene
