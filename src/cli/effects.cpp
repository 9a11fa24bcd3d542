// mortise effects [NAME]: what physics there is, from the same tables that check scenes.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>

#include "cli/commands.h"
#include "effects/list.h"
#include "scene/checker.h"
#include "scene/quantity.h"
#include "scene/suggest.h"

namespace mortise::cli {
namespace {

const char* kind_text(Param::Kind kind) {
  switch (kind) {
    case Param::Kind::number:
      return "number";
    case Param::Kind::integer:
      return "whole number";
    case Param::Kind::flag:
      return "true or false";
    case Param::Kind::text:
      return "text";
    case Param::Kind::path:
      return "file";
    case Param::Kind::choice:
      return "one of";
    case Param::Kind::vec3:
      return "[x, y, z]";
    case Param::Kind::numbers:
      return "list of numbers";
    case Param::Kind::vec3s:
      return "list of [x, y, z]";
    case Param::Kind::schedule:
      return "number, or {time: [...], value: [...]}";
    case Param::Kind::names:
      return "list of names";
    case Param::Kind::pairs:
      return "list of [name, name]";
    case Param::Kind::table:
      return "block";
    case Param::Kind::tables:
      return "block, or a list of blocks";
    case Param::Kind::map:
      return "named blocks";
  }
  return "";
}

// "number [Pa], > 0, default 1 MPa"
std::string type_text(const Param& p) {
  std::string out = kind_text(p.kind);
  if (p.kind == Param::Kind::choice) out += " " + scene::join(p.choices, ", ");
  if (const std::string unit = scene::si_symbol(p.unit); !unit.empty() && p.unit != Unit::any) out += " [" + unit + "]";
  Param bare = p;  // the unit has been said
  bare.unit = Unit::none;
  if (const std::string range = scene::range_text(bare); !range.empty()) out += ", " + range;
  if (p.fallback && p.kind != Param::Kind::table)
    out += ", default " + (p.fallback->empty() ? "empty" : *p.fallback);
  else if (!p.fallback)
    out += p.optional ? ", optional" : ", required";
  return out;
}

void print_params(const ParamTable& t, int indent) {
  std::size_t width = 0;
  for (const Param& p : t.params) width = std::max(width, p.key.size());
  for (const Param& p : t.params) {
    std::cout << fmt::format("{:{}}{:<{}}  {}\n", "", indent, p.key, width, type_text(p));
    std::cout << fmt::format("{:{}}{}\n", "", indent + width + 2, p.help);
    if (p.sub) print_params(*p.sub, indent + static_cast<int>(width) + 2);
  }
}

int cmd_effects(const std::string& wanted) {
  const effects::KindList& kinds = effects::list();
  std::vector<std::string> names;
  std::size_t width = 0;
  for (const effects::Kind& k : kinds) names.push_back(k.name), width = std::max(width, names.back().size());
  if (wanted.empty()) {
    for (const effects::Kind& k : kinds) std::cout << fmt::format("{:<{}}  {}\n", k.name, width, k.help);
    return 0;
  }
  const effects::Kind* k = effects::find_kind(wanted);
  if (!k) {
    const std::string hint = scene::suggestion(wanted, names);
    throw Error(Exit::usage, "unknown effect '" + wanted + "'" + (hint.empty() ? "" : "\n  " + hint));
  }
  std::cout << fmt::format("{} - {}\n", k->name, k->help);
  if (k->table->help != k->help && !k->table->help.empty()) std::cout << fmt::format("\n{}\n", k->table->help);
  if (k->table->is_list)
    std::cout << fmt::format("\nThe value is a block, or a list of blocks, of these keys:\n");
  else if (k->table->params.empty())
    std::cout << fmt::format("\nIt has no keys: write '{}: {{}}'.\n", k->name);
  else
    std::cout << fmt::format("\nKeys:\n");
  print_params(*k->table, 2);
  if (!k->papers.empty()) std::cout << fmt::format("\nPapers:\n");
  for (const std::string& paper : k->papers) std::cout << fmt::format("  {}\n", paper);
  return 0;
}

}  // namespace

void add_effects(Command app, Context& context) {
  const Command sub = app.command("effects", "list the effects a scene can name, or explain one");
  auto name = std::make_shared<std::string>();
  sub.option("name", *name, "effect to explain: its keys with units, ranges and defaults, and its papers");
  sub.footer("Examples:\n  mortise effects\n  mortise effects friction");
  sub.action([name, &context] { context.action = [name] { return cmd_effects(*name); }; });
}

}  // namespace mortise::cli
