#pragma once
// States of an engine that go to a file of its own for as long as quantities are measured in it.
#include <memory>
#include <string>
#include <vector>

#include "base/snapshot.h"
#include "engine/engine.h"
#include "model/input.h"
#include "output/field_file.h"
#include "output/field_reader.h"
#include "run/state_audit.h"
#include "sensors/sensors.h"
#include "study/study.h"

namespace mortise::study {

// Throws what an engine's outcome says.
void check(const engine::Outcome& outcome);

class Recording {
 public:
  // Both outlive it.
  Recording(engine::Engine& engine, const model::ModelInput& input, std::string file);
  Recording(const Recording&) = delete;
  ~Recording();

  // Writes the state at the start.
  void open();
  // Takes note of the state after a step, and writes it where it makes a frame. report: of the step; null of those that only follow.
  void see(const solver::StepReport* report, bool frame);
  // No state follows.
  const output::FieldReader& read();
  std::vector<double> measure(const std::vector<Quantity>& quantities);

 private:
  engine::Engine& engine_;
  const model::ModelInput& input_;
  const std::string file_;
  std::unique_ptr<output::FieldFile> out_;
  std::unique_ptr<output::FieldReader> reader_;
  sensors::Sensors sensors_;
  run::EnergyAudit audit_;
};

}  // namespace mortise::study
