#include "sweep/blocks.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>

#include "base/philox.h"
#include "base/read_file.h"
#include "scene/distribution.h"
#include "scene/flow.h"
#include "scene/suggest.h"

namespace mortise::sweep {
namespace {

using scene::Diagnostics;
using scene::Distribution;
using scene::flow;
using scene::Node;
using scene::read_distribution;

// path -> list of values; false after an error.
bool columns(const Node& node, const std::string& what, Diagnostics& errors) {
  if (node.kind != Node::Kind::map || node.entries.empty())
    return errors.add(node.at, what + " is " + node.describe() + "; must be a block of PATH: [values]"), false;
  bool fine = true;
  for (const auto& [path, values] : node.entries)
    if (values.kind != Node::Kind::list || values.items.empty())
      errors.add(values.at, what + "." + path +
                                (values.kind == Node::Kind::list ? std::string(" is an empty list")
                                                                 : " is " + values.describe() + "; must be a list of values")),
          fine = false;
  return fine;
}

std::vector<Row> product(const Node& node, Diagnostics& errors) {
  if (!columns(node, "product", errors)) return {};
  std::vector<Row> out{{}};
  for (const auto& [path, values] : node.entries) {
    std::vector<Row> next;
    for (const Row& row : out)
      for (const Node& v : values.items) {
        next.push_back(row);
        next.back().values.emplace_back(path, flow(v));
      }
    out = std::move(next);
  }
  return out;
}

std::vector<Row> zip(const Node& node, Diagnostics& errors) {
  if (!columns(node, "zip", errors)) return {};
  const auto& [first, values] = node.entries.front();
  std::vector<Row> out(values.items.size());
  for (const auto& [path, column] : node.entries) {
    if (column.items.size() != out.size())
      return errors.add(column.at, "zip." + path + " has " + std::to_string(column.items.size()) + " values, zip." + first + " has " +
                                       std::to_string(out.size())),
             std::vector<Row>{};
    for (std::size_t i = 0; i < out.size(); ++i) out[i].values.emplace_back(path, flow(column.items[i]));
  }
  return out;
}

struct Draws {
  std::size_t count = 0;
  std::uint64_t seed = 0;
  std::vector<std::pair<std::string, Distribution>> vary;
};

Draws draws(const Node& node, const std::string& what, Diagnostics& errors) {
  static const std::vector<std::string> kKeys{"count", "seed", "vary"};
  Draws out;
  if (node.kind != Node::Kind::map) return errors.add(node.at, what + " is " + node.describe() + "; must be a block with count, seed and vary"), out;
  for (const auto& [key, value] : node.entries)
    if (!std::count(kKeys.begin(), kKeys.end(), key)) errors.add(value.key_at, "unknown key '" + key + "' in " + what, scene::suggestion(key, kKeys));
  const auto whole = [&](const char* key, std::uint64_t least) -> std::uint64_t {
    const Node* n = node.find(key);
    if (!n) return errors.add(node.at, what + " needs '" + std::string(key) + "'"), 0;
    const bool digits =
        !n->text.empty() && n->text.size() < 19 && std::all_of(n->text.begin(), n->text.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!digits || std::stoull(n->text) < least)
      return errors.add(n->at, what + "." + key + " is " + n->describe() + "; must be a whole number from " + std::to_string(least)), 0;
    return std::stoull(n->text);
  };
  out.count = whole("count", 1), out.seed = whole("seed", 0);
  const Node* vary = node.find("vary");
  if (!vary || vary->kind != Node::Kind::map || vary->entries.empty())
    return errors.add(vary ? vary->at : node.at, what + " needs 'vary', a block of PATH: {uniform: [a, b]}"), out;
  for (const auto& [path, how] : vary->entries) out.vary.emplace_back(path, read_distribution(how, what + ".vary." + path, errors));
  return out;
}

std::vector<Row> random(const Node& node, Diagnostics& errors) {
  const Draws d = draws(node, "random", errors);
  std::vector<Row> out(d.count);
  for (const auto& [path, distribution] : d.vary)
    for (std::size_t i = 0; i < d.count; ++i) out[i].values.emplace_back(path, distribution.at(Stream(d.seed, path).at(i)[0]));
  return out;
}

// In each parameter one draw in each of `count` equally probable strata, in an order of its own (McKay, Beckman, Conover, Technometrics 21(2), 1979).
std::vector<Row> latin_hypercube(const Node& node, Diagnostics& errors) {
  const Draws d = draws(node, "latin_hypercube", errors);
  std::vector<Row> out(d.count);
  for (const auto& [path, distribution] : d.vary) {
    const Stream stream(d.seed, path);
    std::vector<std::size_t> order(d.count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return stream.at(a)[0] < stream.at(b)[0]; });
    for (std::size_t i = 0; i < d.count; ++i)
      out[i].values.emplace_back(path, distribution.at((static_cast<double>(order[i]) + stream.at(i)[1]) / static_cast<double>(d.count)));
  }
  return out;
}

// Fields of a line of comma-separated values; "a, b" in quotes is one, "" in quotes is a quote.
std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> out{""};
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      out.back() += line[++i];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      out.emplace_back();
    else if (line[i] != '\r')
      out.back() += line[i];
  }
  for (std::string& f : out) {
    f.erase(0, f.find_first_not_of(" \t"));
    f.erase(f.find_last_not_of(" \t") + 1);
  }
  return out;
}

// Comma-separated values; the first line has the paths.
std::vector<Row> file(const Node& node, const std::string& folder, Diagnostics& errors) {
  const std::string path = (std::filesystem::path(folder) / node.text).lexically_normal().string();
  std::string text;
  try {
    text = read_regular_file(path, max_bytes::scene);
  } catch (const Error& e) {
    return errors.add(node.at, e.what()), std::vector<Row>{};
  }
  std::vector<std::string> paths;
  std::vector<Row> out;
  int line_number = 0;
  for (std::size_t begin = after_mark(text); begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1, ++line_number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::vector<std::string> values = fields(line);
    if (paths.empty()) {
      paths = values;
      if (paths.size() == 1 && paths[0].find_first_of(";\t") != std::string::npos) {
        errors.add(node.at, path + ":" + std::to_string(line_number) + " has no comma; values are separated by commas");
        return {};
      }
      continue;
    }
    if (values.size() != paths.size()) {
      errors.add(node.at, path + ":" + std::to_string(line_number) + " has " + std::to_string(values.size()) + " values, the first line has " +
                              std::to_string(paths.size()) + " paths");
      return {};
    }
    Row row;
    for (std::size_t i = 0; i < paths.size(); ++i) row.values.emplace_back(paths[i], values[i]);
    out.push_back(std::move(row));
  }
  if (out.empty()) errors.add(node.at, path + " has no rows below its line of paths");
  return out;
}

}  // namespace

std::vector<std::string> block_names() { return {"product", "zip", "random", "latin_hypercube", "file"}; }

std::vector<Row> rows_of_block(const Node& block, const std::string& folder, Diagnostics& errors) {
  if (block.kind != Node::Kind::map || block.entries.size() != 1)
    return errors.add(block.at, "an entry of rows is " + block.describe() + "; must have one key of " + scene::join(block_names(), ", ")),
           std::vector<Row>{};
  const auto& [name, node] = block.entries.front();
  if (name == "product") return product(node, errors);
  if (name == "zip") return zip(node, errors);
  if (name == "random") return random(node, errors);
  if (name == "latin_hypercube") return latin_hypercube(node, errors);
  if (name == "file") return file(node, folder, errors);
  return errors.add(node.key_at, "no block '" + name + "' of rows", scene::suggestion(name, block_names())), std::vector<Row>{};
}

}  // namespace mortise::sweep
