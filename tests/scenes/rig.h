#pragma once
// Runs scenes in memory: YAML text through the real reader, mesh generators and engine; reports are captured by name.
#include <gtest/gtest.h>

#include "base/memory_archive.h"
#include "base/snapshot.h"
#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "scene/scene.h"

namespace mortise::testing {

// Asked for a number that nobody reported, the test fails.
class Captured : public Snapshot {
 public:
  double at(const std::string& name) const {
    if (!has(name)) {
      std::string known;
      for (const auto& [k, v] : number) known += " " + k;
      ADD_FAILURE() << "no scalar " << name << "; there are:" << known;
    }
    return Snapshot::at(name);
  }
};

class Rig {
 public:
  // file: what the scene's meshes are sought beside.
  explicit Rig(const std::string& yaml, const std::vector<std::string>& overrides = {}, const std::string& file = "test.yaml") {
    scene = scene::read_scene_text(yaml, file, overrides, engine::effect_tables());
    input = engine::make_input(scene.root);
    start();
  }
  explicit Rig(model::ModelInput of) : input(std::move(of)) { start(); }
  solver::StepReport step() {
    solver::StepReport report;
    check(engine->step({}, report));
    return report;
  }
  void steps(int n) {
    for (int i = 0; i < n; ++i) step();
  }
  // Goes on in a new engine, from a checkpoint.
  void resume() {
    MemoryArchive archive;
    check(engine->checkpoint(archive));
    start();
    archive.rewind();
    check(engine->checkpoint(archive));
  }
  Captured fields() {
    Captured out;
    engine->report(out);
    return out;
  }
  static void check(const engine::Outcome& o) {
    if (o.code != 0) throw Error(static_cast<Exit>(o.code), o.message);
  }

  scene::Scene scene;
  model::ModelInput input;
  std::unique_ptr<engine::Engine> engine;

 private:
  void start() { check(engine::chosen().api->create(input, engine)); }
};

inline Vec3 vector(const Captured& f, const std::string& stem) { return {f.at(stem + "x"), f.at(stem + "y"), f.at(stem + "z")}; }

}  // namespace mortise::testing
