#pragma once
// Runs scenes in memory: YAML text through the real reader, mesh generators and engine; reports are captured by name.
#include <gtest/gtest.h>

#include <map>

#include "base/memory_archive.h"
#include "engine/effect_tables.h"
#include "engine/choose.h"
#include "engine/input.h"
#include "scene/scene.h"

namespace mortise::testing {

class Captured : public FieldSink {
 public:
  void points(std::string_view name, std::string_view, int, std::span<const double> v) override { point[std::string(name)].assign(v.begin(), v.end()); }
  void cells(std::string_view name, std::string_view, int, std::span<const double> v) override { cell[std::string(name)].assign(v.begin(), v.end()); }
  void rows(std::string_view group, std::string_view name, std::string_view, int, std::span<const double> v) override {
    row[std::string(group) + "/" + std::string(name)].assign(v.begin(), v.end());
  }
  void scalar(std::string_view group, std::string_view name, std::string_view, double v) override { number[std::string(group) + "/" + std::string(name)] = v; }
  double at(const std::string& name) const {
    const auto it = number.find(name);
    if (it == number.end()) {
      std::string known;
      for (const auto& [k, v] : number) known += " " + k;
      ADD_FAILURE() << "no scalar " << name << "; there are:" << known;
      return NAN;
    }
    return it->second;
  }
  std::map<std::string, std::vector<double>> point, cell, row;
  std::map<std::string, double> number;
};

class Rig {
 public:
  // file: what the scene's meshes are sought beside.
  explicit Rig(const std::string& yaml, const std::vector<std::string>& overrides = {}, const std::string& file = "test.yaml") {
    scene = scene::read_scene_text(yaml, file, overrides, engine::effect_tables());
    input = engine::make_input(scene.root);
    check(engine::chosen().api->create(input, engine));
  }
  solver::StepReport step() {
    solver::StepReport report;
    check(engine->step({}, report));
    return report;
  }
  void steps(int n) {
    for (int i = 0; i < n; ++i) step();
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
};

}  // namespace mortise::testing
