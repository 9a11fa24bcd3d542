// libFuzzer target: the scene reader. Whatever the bytes, it returns a scene or throws Error; a scene it accepts it reads again from what
// to_yaml writes. One made-up effect has a parameter of every kind.
//   cmake --preset fuzz && ninja -C build/fuzz fuzz_scene && build/fuzz/bin/fuzz_scene -max_total_time=600 tests/cli/bad scenes/first scenes/hard
#include "scene/scene.h"

#include <cstdint>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "scene/schema.h"

using namespace mortise;
using Kind = Param::Kind;

namespace {

const ParamTable kInner{
    "inner", "", {param::of(Kind::number, "time_constant", Unit::time, {}, "Number."), param::of(Kind::numbers, "time", Unit::time, {}, "Times.")}};

const ParamTable& everything() {
  static const ParamTable table = [] {
    ParamTable t{"everything", "", {}};
    const auto add = [&](Kind kind, const char* key, Unit unit) {
      Param p = param::optional(param::of(kind, key, unit, {}, key));
      if (kind == Kind::table || kind == Kind::tables || kind == Kind::map) p.sub = &kInner;
      if (kind == Kind::choice) p.choices = {"one", "two"};
      t.params.push_back(p);
    };
    add(Kind::number, "d_hat", Unit::length), add(Kind::integer, "count", Unit::none), add(Kind::flag, "flag", Unit::none),
        add(Kind::text, "body", Unit::none);
    add(Kind::path, "file", Unit::none), add(Kind::choice, "form", Unit::none), add(Kind::vec3, "axis", Unit::none),
        add(Kind::numbers, "numbers", Unit::any);
    add(Kind::vec3s, "translation", Unit::length), add(Kind::schedule, "pressure", Unit::pressure), add(Kind::table, "where", Unit::none);
    add(Kind::names, "bodies", Unit::none), add(Kind::pairs, "pairs", Unit::none), add(Kind::tables, "list", Unit::none),
        add(Kind::map, "map", Unit::none);
    return t;
  }();
  return table;
}

const ParamTable kNone{"none", "", {}};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const scene::EffectTable effects[] = {{"everything", "All kinds of parameters.", &everything()},
                                        {"inertia", "", &kNone, {}, {}, true},
                                        {"gravity", "", &kNone},
                                        {"elasticity", "", &kNone},
                                        {"barrier_contact", "", &everything()},
                                        {"affine_body", "", &kNone}};
  // A line that begins with "--set " is an override.
  std::string text(reinterpret_cast<const char*>(data), size);
  std::vector<std::string> sets;
  if (text.rfind("--set ", 0) == 0) {
    const std::size_t end = text.find('\n');
    sets.push_back(text.substr(6, end - 6));
    text = end == std::string::npos ? "" : text.substr(end + 1);
  }
  try {
    const scene::Scene first = scene::read_scene_text(text, "/fuzz/scene.yaml", sets, effects);
    const std::string written = scene::to_yaml(first.root);
    try {
      if (scene::to_yaml(scene::read_scene_text(written, "/fuzz/scene.yaml", {}, effects).root) != written) std::abort();
    } catch (const Error&) {
      std::abort();  // what we write ourselves must be readable
    }
  } catch (const Error&) {
  }
  return 0;
}
