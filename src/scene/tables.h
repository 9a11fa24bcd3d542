#pragma once
// The blocks of a scene that are not effects: what `time`, a material, a body, ... may hold.
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/param_table.h"
#include "scene/scene.h"

namespace mortise::scene {

// A block whose keys depend on one choice (a body: on its type).
struct Variants {
  const ParamTable* table;  // stands for all of them; holds only the choice
  std::string key;
  std::vector<std::pair<std::string, const ParamTable*>> of;
};
const Variants* variants_of(const ParamTable&);  // null for ordinary blocks

// The root block, with the given effects under `effects`.
class SceneTables {
 public:
  explicit SceneTables(std::span<const EffectTable> effects);
  SceneTables(const SceneTables&) = delete;
  SceneTables& operator=(const SceneTables&) = delete;
  const ParamTable& root() const { return root_; }

 private:
  ParamTable effects_, root_;
};

inline constexpr int kFormatVersion = 1;

}  // namespace mortise::scene
