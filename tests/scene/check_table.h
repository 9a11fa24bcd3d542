#pragma once
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "scene/checker.h"
#include "scene/tables.h"
#include "scene/yaml.h"

namespace mortise::scene {

// Every table reachable from t: keys once, defaults that the checker takes, choices that exist.
inline void check_table(const ParamTable& t, const std::string& path) {
  std::set<std::string> keys;
  if (const Variants* variants = variants_of(t))
    for (const auto& [name, table] : variants->of) check_table(*table, path + "(" + name + ")");
  for (const Param& p : t.params) {
    EXPECT_TRUE(keys.insert(p.key).second) << path << "." << p.key << " appears twice";
    EXPECT_FALSE(p.help.empty()) << path << "." << p.key;
    const bool needs_sub = p.kind == Param::Kind::table || p.kind == Param::Kind::tables || p.kind == Param::Kind::map;
    EXPECT_EQ(p.sub != nullptr, needs_sub) << path << "." << p.key;
    if (p.sub) check_table(*p.sub, path + "." + p.key);
    if (!p.fallback || p.key == "description") continue;
    Diagnostics errors(*p.fallback);
    ParamTable only{"", "", {p}};
    Checker(errors, ".").table(only, Node{}, path);
    EXPECT_TRUE(errors.empty()) << path << "." << p.key << " has a default that is not valid: " << *p.fallback;
  }
}

}  // namespace mortise::scene
