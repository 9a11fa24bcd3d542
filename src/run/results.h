#pragma once
// What a run leaves in its folder, but for checkpoints: fields.vtkhdf, pictures, newton.csv and, at its end, certificate.json and run.json.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "audit/certificate.h"
#include "audit/checks.h"
#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"
#include "output/checkpoint.h"
#include "output/field_file.h"
#include "run/folder.h"
#include "run/newton_log.h"
#include "run/pictures.h"
#include "run/progress.h"
#include "run/record.h"
#include "run/sensor_maps.h"
#include "run/sensor_reach.h"
#include "sensors/sensors.h"

namespace mortise::run {

class Results {
 public:
  // scene: the whole, of which `hash` is the identity. Throws Error(Exit::file).
  Results(const Options& options, const Params& scene, std::string hash, const model::ModelInput& input, const Folder& folder,
          const sensors::Sensors& sensors, Record& record);

  // The file of fields is new; resolved: the scene as the program understood it.
  void begin(const model::ModelInput& input, const std::string& resolved);
  // Or it goes on where a checkpoint left it, with all that was gathered until then; `resolved` may have more steps than that run had.
  void go_on(output::CheckpointReader& from, const std::string& resolved);

  // A step that was tried, whatever became of it.
  void tried(const solver::StepReport& report) { newton_log_.step(report); }
  // A state: at the start, or that a step led to. It has a frame or a line.
  struct State {
    double time;  // [s]
    Snapshot& said;
    const std::vector<double>& points;
    const solver::StepReport* step;  // null at the start
    bool frame;
  };
  void state(const State& now);
  long frames() const { return file_ ? file_->frames() : 0; }
  const audit::ContactFigures& contact() const { return contact_; }  // of the last state that a step led to

  void flush() { file_->flush(); }
  void close() { file_->close(); }
  void checkpoint(Archive& archive);  // of what was gathered

  struct End {
    Exit status;
    std::string message;  // of the error, empty without one
    double wall;          // of the run [s]
    const engine::Engine* engine;
    const Estimated& estimated;  // how wrong quantities are
    audit::Grade grade{};        // that it got
  };
  // Writes how it ended, and grades it. Checks that failed are told to `note`, and make another end of one that was good.
  // tell: of checks that were not met.
  void finish(End& end, const std::function<void(const std::string&)>& note, const std::function<void(const std::string&)>& tell);

 private:
  output::FileInfo info(const std::string& resolved) const;
  void frame(const State& now);
  void line(const State& now);
  void audit(const audit::EnergyAudit::Result& energy);
  std::vector<audit::Checks::Verdict> verdicts(const End& end, const std::function<void(const std::string&)>& note) const;

  const Options& options_;
  const Params& scene_;
  const std::string hash_;
  const Folder& folder_;
  const sensors::Sensors& sensors_;
  Record& record_;
  output::FieldOptions fields_;
  std::unique_ptr<output::FieldFile> file_;
  NewtonLog newton_log_;
  audit::Certificate certificate_;
  audit::Checks checks_;
  std::unique_ptr<Pictures> pictures_;
  std::optional<SensorMaps> sensor_maps_;
  SensorReach sensor_reach_;
  bool whole_ = true;  // no part of it was run by another process
  long picture_every_ = 1;
  audit::ContactFigures contact_;
};

}  // namespace mortise::run
