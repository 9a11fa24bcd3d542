#pragma once
// A run of a scene in this process, whose states go to a file for as long as quantities are measured in it.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "audit/state_audit.h"
#include "base/snapshot.h"
#include "engine/choose.h"
#include "engine/input.h"
#include "output/field_file.h"
#include "scene/scene.h"
#include "sensors/sensors.h"
#include "study/study.h"

namespace mortise::study {

// Throws what an engine's outcome says.
void check(const engine::Outcome& outcome);

class Course {
 public:
  Course(const scene::Scene& scene, const std::string& file, const engine::Choice& choice);
  // Of the same bodies.
  Course(const Course& other, const std::string& file, const engine::Choice& choice);
  Course(const Course&) = delete;
  ~Course();

  engine::Engine& engine() { return *engine_; }
  const model::ModelInput& input() const { return input_; }
  // Writes the state at the start.
  void open();
  // Takes note of the state after a step, and writes it where it makes a frame. report: of the step; null of those that only follow.
  void see(const solver::StepReport* report, bool frame);
  const Snapshot& state() const { return state_; }               // the last
  const std::vector<double>& points() const { return points_; }  // there, three per point [m]
  // No state follows.
  std::vector<double> measure(const std::vector<Quantity>& quantities);
  // After that:
  std::vector<double> missed_between(const std::vector<Quantity>& quantities) const;
  std::vector<double> largest_apart(const Course& other, const std::vector<Quantity>& quantities) const;

 private:
  Course(const scene::Scene& scene, const model::ModelInput& input, const std::string& file, const engine::Choice& choice);
  const scene::Scene scene_;
  const model::ModelInput input_;
  const std::string file_;
  std::unique_ptr<engine::Engine> engine_;
  std::unique_ptr<output::FieldFile> out_;
  sensors::Sensors sensors_;
  audit::EnergyAudit audit_;
  Snapshot state_;
  std::vector<double> points_;
};

// Takes `first`, which has begun, through all of its steps, and those that it leads along; `see` its states. Returns the CPU time of the steps [s].
double take(Course& first, const std::vector<Course*>& beside, const std::function<void(const Snapshot&)>& see = {});

}  // namespace mortise::study
