#include "engine/effect_tables.h"

#include "effects/list.h"

namespace mortise::engine {

std::vector<scene::EffectTable> effect_tables() {
  std::vector<scene::EffectTable> out;
  for (const effects::Kind& kind : effects::list())
    out.push_back({kind.name, kind.help, kind.table, kind.point_fields, kind.cell_fields, kind.role == effects::Role::inertia,
                   kind.role == effects::Role::contact, kind.role == effects::Role::tie});
  return out;
}

}  // namespace mortise::engine
