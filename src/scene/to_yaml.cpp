#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/read_file.h"
#include "base/sha256.h"
#include "scene/quantity.h"
#include "scene/scene.h"

namespace mortise::scene {
namespace {

// Always in double quotes (YAML contains JSON's strings), but for plain words that no YAML reader takes for something else.
std::string quoted(const std::string& s) {
  static const std::vector<std::string> reserved{"true", "false", "null", "yes", "no", "on", "off", "y", "n"};
  const bool word = !s.empty() && s.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == std::string::npos &&
                    std::find(reserved.begin(), reserved.end(), s) == reserved.end();
  return word ? s : json_text(nlohmann::json(s));
}

std::string flow(const Params& p) {
  switch (p.kind()) {
    case Params::Kind::number:
      return format_number(p.as_number());
    case Params::Kind::integer:
      return std::to_string(p.as_integer());
    case Params::Kind::flag:
      return p.as_flag() ? "true" : "false";
    case Params::Kind::text:
      return quoted(p.as_text());
    case Params::Kind::list: {
      std::string out;
      for (const Params& item : p.items()) out += (out.empty() ? "" : ", ") + flow(item);
      return "[" + out + "]";
    }
    case Params::Kind::table: {
      std::string out;
      for (const auto& [key, value] : p.entries()) out += (out.empty() ? "" : ", ") + key + ": " + flow(value);
      return "{" + out + "}";
    }
    case Params::Kind::none:
      break;
  }
  return "~";
}

void block(const Params& table, int indent, std::string& out) {
  for (const auto& [key, value] : table.entries()) {
    out += std::string(indent, ' ') + key + ":";
    const std::string line = flow(value);
    // What fits on a line stays on it; deeper blocks and lists of blocks get lines of their own.
    if (value.kind() == Params::Kind::table && !value.entries().empty() && (indent == 0 || line.size() > 90)) {
      out += "\n";
      block(value, indent + 2, out);
    } else if (value.kind() == Params::Kind::list && !value.items().empty() && value.items()[0].kind() == Params::Kind::table) {
      out += "\n";
      for (const Params& item : value.items()) out += std::string(indent + 2, ' ') + "- " + flow(item) + "\n";
    } else {
      out += " " + line + "\n";
    }
  }
}

// Files by what is in them.
Params contents(const Params& p) {
  if (p.is_path()) return Params::make_text("sha256:" + sha256(read_regular_file(p.as_text(), max_bytes::mesh)));
  if (p.kind() == Params::Kind::list) {
    Params out = Params::make_list();
    for (const Params& item : p.items()) out.push(contents(item));
    return out;
  }
  if (p.kind() != Params::Kind::table) return p;
  Params out = Params::make_table();
  for (const auto& [key, value] : p.entries()) out.set(key, contents(value));
  return out;
}

}  // namespace

std::string identity(const Params& root) { return sha256(to_yaml(contents(root))); }

std::string to_yaml(const Params& root) {
  std::string out;
  block(root, 0, out);
  return out;
}

}  // namespace mortise::scene
