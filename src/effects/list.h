#pragma once
// The one visible list of effects. A new effect is one folder, one line in list.cpp and one test file.
#include <memory>
#include <span>

#include "base/param_table.h"
#include "base/params.h"
#include "effects/effect.h"

namespace mortise::model {
class Model;
}

namespace mortise::effects {

struct Kind {
  const char* name;
  const char* help;  // one line
  const ParamTable* table;
  std::unique_ptr<Effect> (*make)(const Params&, model::Model&);
  std::vector<std::string> papers;  // printed by --citations
  std::vector<std::string> point_fields{}, cell_fields{};  // that it reports: what scenes may keep and colour by
};

std::span<const Kind> list();  // in the order in which effects act within a step

}  // namespace mortise::effects
