// mortise schema: the JSON Schema that editors check and complete scenes by.
#include "scene/schema.h"

#include <iostream>

#include "cli/commands.h"
#include "engine/effect_tables.h"

namespace mortise::cli {
namespace {

int cmd_schema() {
  std::cout << scene::schema(engine::effect_tables());
  return 0;
}

}  // namespace

void add_schema(Command app, Context& context) {
  const Command sub = app.command("schema", "print the JSON Schema (draft-07) of scene files");
  sub.footer("Example:\n  mortise schema > schemas/scene.schema.json");
  sub.action([&context] { context.action = cmd_schema; });
}

}  // namespace mortise::cli
