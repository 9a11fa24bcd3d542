#pragma once
#include <optional>
#include <set>
#include <string>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"
#include "scene/yaml.h"

namespace mortise::scene {

// Turns the written tree into a checked one, block by block, by the tables. What is wrong is added to the diagnostics and left
// out of the result, so that one pass finds everything.
class Checker {
 public:
  // `folder`: relative paths in the scene start here.
  Checker(Diagnostics& errors, std::string folder) : errors_(errors), folder_(std::move(folder)) {}

  // `path` is the dotted name of the block, "" for the root.
  Params table(const ParamTable&, const Node&, const std::string& path);

  // Blocks with an unknown key or a value that is wrong: what seems to be missing there is most likely one of these.
  const std::set<std::string>& incomplete() const { return incomplete_; }

 private:
  std::optional<Params> value(const Param&, const Node&, const std::string& path);
  std::optional<Params> number(const Param&, const Node&, const std::string& path);
  std::optional<Params> integer(const Param&, const Node&, const std::string& path);
  std::optional<Params> flag(const Node&, const std::string& path);
  std::optional<Params> text(const Param&, const Node&, const std::string& path);
  std::optional<Params> choice(const Param&, const Node&, const std::string& path);
  std::optional<Params> file(const Node&, const std::string& path);
  std::optional<Params> schedule(const Param&, const Node&, const std::string& path);
  std::optional<Params> list(const Param&, const Node&, const std::string& path);
  Params map(const Param&, const Node&, const std::string& path);
  std::optional<Params> in_range(const Param&, double v, const Node&, const std::string& path, Params result);
  void one_of(const ParamTable&, const Node&, const std::string& path);
  void times(const ParamTable&, const Params&, const std::string& path);
  void lengths(const ParamTable&, const Params&, std::size_t wanted, const std::string& time_path, const std::string& path);

  Diagnostics& errors_;
  std::string folder_;
  std::set<std::string> incomplete_;
};

// "a.b" from "a" and "b"; just "b" at the root.
std::string dotted(const std::string& path, const std::string& key);

// Keys that start with "x-" are the user's own (anchors, notes) and are skipped everywhere.
bool is_private_key(const std::string& key);

// Range of a number in words: ">= 0 m", "in [0, 0.5)"; "" when everything is allowed.
std::string range_text(const Param&);

bool is_name(const std::string&);  // [a-z0-9_-]+

}  // namespace mortise::scene
