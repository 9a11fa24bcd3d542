#include "run/run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/memory_archive.h"
#include "base/shell.h"
#include "base/version.h"
#include "bridge/bridge.h"
#include "cost/predict.h"
#include "engine/input.h"
#include "output/atomic_file.h"
#include "output/checkpoint.h"
#include "output/field_file.h"
#include "output/field_reader.h"
#include "output/run_json.h"
#include "run/alone.h"
#include "run/batch.h"
#include "run/bridged.h"
#include "run/certificate.h"
#include "run/checks.h"
#include "run/environment.h"
#include "run/folder.h"
#include "run/newton_log.h"
#include "run/output_mesh.h"
#include "run/pictures.h"
#include "run/progress.h"
#include "run/record.h"
#include "run/reset_watch.h"
#include "run/sensor_facts.h"
#include "run/sensor_maps.h"
#include "run/signals.h"
#include "run/step_row.h"
#include "run/stopwatch.h"
#include "run/warnings.h"
#include "scene/environments.h"
#include "sensors/sensors.h"

namespace fs = std::filesystem;

namespace mortise::run {
namespace {

using Time = std::chrono::steady_clock;

void check(const engine::Outcome& outcome) {
  if (outcome.code != 0) throw Error(static_cast<Exit>(outcome.code), outcome.message, outcome.located);
}

// What a run without a checkpoint may replace: results that --overwrite gives up, and a start that was cut short before its first checkpoint.
void clear_folder(const Options& o, const Folder& folder, const std::string& hash) {
  if (!folder.used()) return;
  const std::string &dir = folder.path(), fields = folder.file("fields.vtkhdf");
  if (!o.overwrite && o.resume.empty())
    throw Error(Exit::usage, "'" + dir + "' is not empty; use --overwrite to replace its results, --resume to continue, or another -o");
  std::error_code ec;
  if (!o.overwrite && fs::exists(fs::symlink_status(fields, ec))) {
    const output::FieldReader there(fields);
    if (there.scene_sha256() != hash || there.frames() > 1)
      throw Error(Exit::file, "'" + fields + "' holds " + std::to_string(there.frames()) +
                                  " frames, but there is no checkpoint to go on from; --overwrite replaces them");
  }
  folder.remove_results();
}

// Whether to continue, and from what; notes what was skipped.
std::unique_ptr<output::NewestCheckpoint> open_checkpoint(const Options& o, const std::string& dir, const std::string& hash) {
  if (o.resume.empty()) return nullptr;
  if (!output::has_checkpoint(dir)) {
    if (o.resume == "auto") return nullptr;
    throw Error(Exit::file, "--resume: '" + dir + "' has no checkpoint (use --resume=auto to start afresh then)");
  }
  auto out = std::make_unique<output::NewestCheckpoint>(output::open_newest_valid(dir));
  if (out->reader.info().scene_sha256 != hash)
    throw Error(Exit::file, "the checkpoint in '" + dir + "' belongs to another scene, other --set values or other mesh files");
  return out;
}

// One run, from the folder's preparation to certificate.json and run.json.
class Run {
 public:
  Run(const Options& options, scene::Scene scene, Progress& progress, Turn& turn, const bridge::Options* bridge)
      : o_(options), progress_(progress), turn_(turn), scene_(std::move(scene)), bridge_options_(bridge) {}

  Routine<Exit> go() {
    Exit status;
    try {
      status = finish(co_await work(), "");
    } catch (const Error& e) {
      try {
        finish(e.code(), e.what());
      } catch (const Error&) {
        // The first failure is the one to tell.
      }
      throw;
    }
    if (progress_.lost())
      throw Error(Exit::file, "the standard output could not be written to the end; the results in '" + folder_->path() + "' are complete");
    co_return status;
  }

  // The condition that ended an episode; "" where none did.
  std::string ended_by() const { return reset_ && reset_->due() ? reset_->reason() : ""; }

 private:
  Routine<Exit> work() {
    resolved_ = scene::to_yaml(scene_.root);
    hash_ = scene::identity(scene_.root);
    const std::string dir = folder_of(o_, scene_.root);
    frame_every_ = scene_.root.at("time").integer("frame_every");
    steps_ = scene_.root.at("time").integer("steps");
    last_ = o_.frames >= 0 ? std::min(steps_, o_.frames * frame_every_) : steps_;
    if (o_.most_steps >= 0) last_ = std::min(last_, o_.most_steps);

    folder_.emplace(dir);
    std::unique_ptr<output::NewestCheckpoint> checkpoint;
    if (folder_->exists()) {
      note(folder_->lock());
      checkpoint = open_checkpoint(o_, dir, hash_);
      if (checkpoint && checkpoint->reader.info().step >= last_)
        if (const auto code = output::code_of_finished_run(folder_->file("run.json"), hash_)) {
          note(fmt::format("the run in '{}' is finished: there is nothing to continue", dir));
          co_return *code;
        }
    } else if (o_.resume == "yes") {
      throw Error(Exit::file, "--resume: there is no folder '" + dir + "' (use --resume=auto to start afresh then)");
    }

    const model::ModelInput input = engine::make_input(scene_.root);
    const engine::Outcome made = co_await turn_.engine(input, engine_);
    record_.device = turn_.device;
    note(turn_.said);
    check(made);
    sensors_.emplace(input);
    if (bridge_options_) bridge_.emplace(*bridge_options_, input, *sensors_);
    note(folder_->lock());
    if (!checkpoint) clear_folder(o_, *folder_, hash_);
    if (bridge_) note(bridge_->begin(folder_->path(), hash_, checkpoint ? checkpoint->reader.info().step : 0, last_, checkpoint != nullptr));
    certificate_.emplace(input);
    checks_.emplace(input);
    newton_log_.emplace(folder_->file("newton.csv"));
    if (!o_.resets.empty()) reset_.emplace(o_.resets, input);

    output::FieldOptions fields;
    const Params& out = scene_.root.at("output");
    fields.double_precision = out.text("precision") == "double";
    if (const Params* names = out.find("fields"))
      for (const Params& name : names->items()) fields.fields.push_back(name.as_text());
    // A checkpoint commits the frames that it speaks of. Others may be lost in a kill, as --resume computes them again.
    fields.commit_seconds = 1;
    const std::string field_path = folder_->file("fields.vtkhdf");
    if (const Params* every = out.find("checkpoint_every")) {
      if (const Params* steps = every->find("steps")) checkpoint_steps_ = steps->as_integer();
      if (const Params* seconds = every->find("seconds")) checkpoint_seconds_ = seconds->as_number();
    }

    if (o_.checkpoint_every > 0) checkpoint_steps_ = 0, checkpoint_seconds_ = o_.checkpoint_every;

    const Params* render = scene_.root.find("render");
    if (render) picture_every_ = render->integer("every");
    if (!o_.no_render && out.flag("pictures") && render && render->has("cameras"))
      pictures_ = std::make_unique<Pictures>(scene_.root, input, folder_->file("frames"));
    if (!o_.no_render && out.flag("pictures") && !sensors_->empty()) sensor_maps_.emplace(scene_.root, *sensors_, folder_->file("frames"));
    record_.spent("setup", setup_);
    progress_.start(scene_.root.text("name"), summary(input), steps_);
    for (const std::string& w : warnings(input)) note("warning: " + w);

    install_signal_handlers();
    if (checkpoint) {
      for (const std::string& why : checkpoint->skipped) note(why);
      output::CheckpointReader& reader = checkpoint->reader;
      check(engine_->checkpoint(reader));
      checkpoint_own(reader);
      if (bridge_) engine_->command(bridge_->commands());
      file_ = output::FieldFile::reopen(field_path, reader.info().frames, reader.info().step, fields);
      record_.steps = file_->steps();
      // They are of a run that ended; this one has not.
      for (const char* end : {"certificate.json", "run.json"}) ::unlink(folder_->file(end).c_str());
      started_ = true;
      note(fmt::format("continuing at step {}, t = {:.6g} s", engine_->steps_done(), engine_->time()));
    } else {
      started_ = true;
      file_ = output::FieldFile::open(field_path, output_mesh(input), {version(), git_sha1(), resolved_, hash_}, fields);
      write_start();
      progress_.frame(0, 0);
      save();
    }

    while (engine_->steps_done() < last_ && !(reset_ && reset_->due())) {
      if (stop()) co_return stopped();
      if (bridge_ && bridge_->due(engine_->steps_done())) {
        const auto answer = hear();
        if (!answer) co_return stopped();
        if (ended_ = *answer != bridge::Bridge::Answer::go_on; ended_) break;
      }
      const engine::Outcome outcome = co_await turn_.step(*engine_, [this] { return stop(); });
      const solver::StepReport report = turn_.report;
      newton_log_->step(report);
      record_.spent("solve", turn_.wall, turn_.cpu);
      if (outcome.code == static_cast<int>(Exit::stopped)) co_return stopped();
      if (outcome.code == static_cast<int>(Exit::solve)) {
        save();
        const std::string replay = fmt::format("mortise run {} -o {} --resume --frames {}", shell_word(o_.scene), shell_word(folder_->path()),
                                               (engine_->steps_done() + frame_every_) / frame_every_);
        throw Error(Exit::solve, outcome.message + "\n  the last good state is in " + folder_->path() +
                                     "/checkpoint.h5; this replays the moment:\n    " + replay + overrides_text());
      }
      if (!outcome.picture.empty()) {
        const std::string picture = folder_->file("touching.obj");
        output::write_file_atomically(picture, outcome.picture, true);
        throw Error(static_cast<Exit>(outcome.code), outcome.message + "\n  where they touch is drawn in " + picture);
      }
      if (outcome.code == static_cast<int>(Exit::device) && output::has_checkpoint(folder_->path()))
        throw Error(Exit::device, outcome.message + "\n  the last checkpoint in " + folder_->path() +
                                      " is good: --resume continues from it, on a device with more memory or with less contact");
      check(outcome);
      stepped_ = true;
      after_step(report);
    }
    if (bridge_ && !ended_) note(bridge_->ask_last(engine_->steps_done(), [this] { return stop(); }));
    if (ended_) save();
    file_->close();
    // Of the state that a step of this process led to: the next process has no equations of it.
    if (stepped_ && engine_->steps_done() == steps_ && o_.estimate && scene_.root.has("quantities"))
      budget_ = o_.estimate(*engine_, input, field_path), note(without_value());
    if (!ended_by().empty()) note("reset: " + ended_by());
    if (!checkpoint) keep_time(input);
    co_return Exit::done;
  }

  // Quantities that the run has no number for: a name that nothing reports does not undo hours of work, but is told.
  std::string without_value() const {
    std::string text;
    for (const auto& of : nlohmann::json::parse(budget_))
      if (of["value"].is_null())
        text += fmt::format("{}warning: quantity '{}' has no value: {}", text.empty() ? "" : "\n", of["quantity"].get<std::string>(),
                            of["why_not"].get<std::string>());
    return text;
  }

  // For `check --plan`: what a whole scene took on the CPU.
  void keep_time(const model::ModelInput& input) {
    if (record_.device.kind != "cpu" || o_.environment >= 0 || bridge_ || !o_.resets.empty()) return;
    long iterations = 0;
    for (const output::StepRow& row : record_.steps) iterations += row.newton_iterations;
    cost::learn(input, engine_->linear_solver(), record_.device.threads, static_cast<long>(record_.steps.size()), iterations,
                record_.cpu_seconds["solve"]);
  }

  // What is commanded before a step; nothing where the run was asked to stop instead.
  std::optional<bridge::Bridge::Answer> hear() {
    const auto begin = Time::now();
    try {
      const bridge::Bridge::Answer answer = bridge_->ask(engine_->steps_done(), engine_->time(), [this] { return stop(); });
      engine_->command(bridge_->commands());
      record_.seconds["bridge"] += std::chrono::duration<double>(Time::now() - begin).count();
      return answer;
    } catch (const bridge::Partner::Stopped&) {
      return {};
    } catch (const Error& e) {
      save();
      throw Error(e.code(), fmt::format("{}\n  the state of step {} is in {}/checkpoint.h5; --resume with --bridge goes on from there", e.what(),
                                        engine_->steps_done(), folder_->path()));
    }
  }

  void tell(Snapshot state, const std::vector<double>& points) {
    if (!bridge_ || !(bridge_->due(engine_->steps_done()) || engine_->steps_done() == last_)) return;
    const std::vector<sensors::Reading> readings = sensors_->read(state, points);
    bridge_->see(engine_->steps_done(), engine_->time(), state, points, readings);
  }

  std::string overrides_text() const {
    std::string text = o_.environment >= 0 ? fmt::format(" --environment {}", o_.environment) : "";
    if (o_.episode >= 0) text += fmt::format(" --episode {}", o_.episode);
    for (const std::string& s : o_.overrides) text += " --set " + shell_word(s);
    return text;
  }

  std::string summary(const model::ModelInput& input) const {
    std::size_t nodes = 0, tets = 0, stiff = 0;
    for (const model::BodyInput& b : input.bodies) {
      if (b.type == model::BodyType::soft) nodes += b.nodes.size(), tets += b.tets.size();
      if (b.type == model::BodyType::stiff) ++stiff;
    }
    return fmt::format("{} nodes, {} tets, {} stiff bodies; {} steps; {}; linear solver {}; results in {}", nodes, tets, stiff, steps_, device_text(),
                       engine_->linear_solver(), folder_->path());
  }

  std::string device_text() const {
    const device::DeviceInfo& d = record_.device;
    return d.kind != "cuda" ? fmt::format("{} with {} threads", d.kind, d.threads) : d.kind + ": " + d.name;
  }

  void note(const std::string& text) const {
    if (!text.empty()) progress_.note(text);
  }

  void after_step(const solver::StepReport& report) {
    const std::vector<double> points = engine_->points();
    Snapshot state;
    engine_->report(state);
    if (reset_) watch(state, points);
    if (bridge_) tell(state, points);
    const bool frame = engine_->steps_done() % frame_every_ == 0 || engine_->steps_done() == last_step();
    if (frame)
      write_frame(&report, state, points);
    else
      capture(report, state, points);
    certificate_->step(report);
    checks_->step(report);
    progress_.step(report, contact_);
    if (checkpoint_due(frame) || checkpoint_asked(seen_)) save();
    if (frame) progress_.frame(file_->frames() - 1, engine_->time());
  }

  void watch(Snapshot state, const std::vector<double>& points) {
    sensors_->read(state, points);
    if (engine_->steps_done() == 0) reset_->check(scene_.root, state);
    reset_->see(engine_->steps_done(), engine_->time(), state, points);
  }

  bool stop() const {
    return stop_asked() || (o_.walltime > 0 && std::chrono::duration<double>(Time::now() - begin_).count() > o_.walltime - o_.grace);
  }

  // The last step of all has a frame; so has the one that ends an episode.
  long last_step() const { return reset_ && reset_->due() ? engine_->steps_done() : o_.most_steps >= 0 ? last_ : steps_; }

  bool checkpoint_due(bool frame) const {
    if (engine_->steps_done() == last_ || engine_->steps_done() == last_step()) return true;
    if (checkpoint_steps_ > 0) return engine_->steps_done() % checkpoint_steps_ == 0;
    if (checkpoint_seconds_ > 0) return std::chrono::duration<double>(Time::now() - saved_).count() >= checkpoint_seconds_;
    return frame;
  }

  void append(const solver::StepReport& report, const Snapshot& state) {
    contact_ = contact_figures(state);
    const output::StepRow row = step_row(report, contact_);
    file_->append_step(row);
    record_.steps.push_back(row);
  }

  void capture(const solver::StepReport& report, const Snapshot& state, const std::vector<double>& points) {
    certificate_->state(state);
    checks_->state(state, points, engine_->time());
    append(report, state);
  }

  void write_start() {
    Snapshot state;
    engine_->report(state);
    if (bridge_) tell(state, engine_->points());
    write_frame(nullptr, state, engine_->points());
  }

  // `report`: of the step that led to this state, null at the start.
  void write_frame(const solver::StepReport* report, Snapshot& state, const std::vector<double>& points) {
    const Stopwatch output;
    const std::vector<sensors::Reading> readings = sensors_->read(state, points);
    certificate_->state(state);
    file_->begin_frame(engine_->time(), points);
    state.report(*file_);
    if (file_->frames() == 0) write_sensor_facts(scene_.root, *sensors_, *file_);
    audit(checks_->state(state, points, engine_->time()));
    if (report) append(*report, state);
    file_->end_frame();
    record_.spent("output", output);
    const Stopwatch pictures;
    const long frame = file_->frames() - 1;
    const bool drawn = frame % picture_every_ == 0;
    if (pictures_ && drawn) pictures_->draw(frame, engine_->time(), points, state.drawable());
    if (sensor_maps_) sensor_maps_->see(readings);
    if (sensor_maps_ && drawn) sensor_maps_->draw(frame, engine_->time(), readings);
    record_.spent("pictures", pictures);
  }

  // Energies of the frame's state beside what effects report.
  void audit(const EnergyAudit::Result& energy) {
    file_->scalar("audit", "total_energy", "J", energy.total);
    if (!energy.work_is_known) return;
    file_->scalar("audit", "support_work", "J", energy.support_work);
    file_->scalar("audit", "largest_energy_gain", "J", std::isnan(energy.largest_gain) ? 0 : energy.largest_gain);
  }

  // The field file first, so that a checkpoint never speaks of frames that are not there.
  void save() {
    const Stopwatch checkpoint;
    file_->flush();
    output::CheckpointWriter writer(folder_->path(), {version(), hash_, engine_->steps_done(), file_->frames(), engine_->time()});
    check(engine_->checkpoint(writer));
    checkpoint_own(writer);
    writer.commit();
    saved_ = Time::now();
    record_.spent("checkpoint", checkpoint);
  }

  // What this side of the engine has gathered.
  void checkpoint_own(Archive& archive) {
    PrefixedArchive certificate(archive, "run/certificate"), checks(archive, "run/checks"), log(archive, "run/newton_log"),
        maps(archive, "run/sensor_maps");
    certificate_->checkpoint(certificate);
    checks_->checkpoint(checks);
    newton_log_->checkpoint(log);
    if (reset_) {
      PrefixedArchive reset(archive, "run/reset");
      reset_->checkpoint(reset);
    }
    if (bridge_) {
      PrefixedArchive bridge(archive, "run/bridge");
      bridge_->checkpoint(bridge);
    }
    bool drawn = sensor_maps_.has_value();
    maps.io("drawn", drawn);
    if (drawn && sensor_maps_) sensor_maps_->checkpoint(maps);
  }

  Exit stopped() {
    save();
    file_->close();
    note(fmt::format("stopped after step {}; continue with --resume", engine_->steps_done()));
    return Exit::stopped;
  }

  // Returns the code that the program ends with.
  Exit finish(Exit status, std::string message) {
    if (!started_) return status;
    const double wall = std::chrono::duration<double>(Time::now() - begin_).count();
    const std::string device = engine_ ? record_.device.kind : "";
    const std::vector<Checks::Verdict> verdicts = checks_->verdicts(status, message);
    const auto failed = std::count_if(verdicts.begin(), verdicts.end(), [](const Checks::Verdict& v) { return !v.pass; });
    if (status == Exit::done && failed > 0) status = Exit::checks, message = fmt::format("{} of {} checks failed", failed, verdicts.size());
    std::string certificate = certificate_->json({scene_.root.text("name"), hash_, device, status, message, checks_->energy()});
    if (!budget_.empty()) certificate = with_error_budget(certificate, budget_);
    output::write_file_atomically(folder_->file("certificate.json"), Checks::add_to(certificate, verdicts), true);
    for (const Checks::Verdict& v : verdicts)
      if (!v.pass) note(fmt::format("check failed: {}; it is {}", v.text, v.found.empty() ? fmt::format("{:.6g}", v.value) : v.found));
    if (file_ && file_->can_flush()) file_->flush();
    record_.frames = file_ ? file_->frames() : 0;
    record_.write(folder_->file("run.json"), {o_, scene_.root.text("name"), hash_, status, message, wall}, engine_.get());
    if (status == Exit::done || status == Exit::checks) progress_.end(status == Exit::done ? "done" : message, wall);
    return status;
  }

  const Options& o_;
  Progress& progress_;
  Turn& turn_;
  Time::time_point begin_ = Time::now();
  Stopwatch setup_;
  scene::Scene scene_;
  std::string resolved_, hash_;
  std::optional<Folder> folder_;
  std::optional<NewtonLog> newton_log_;
  std::unique_ptr<engine::Engine> engine_;
  std::unique_ptr<output::FieldFile> file_;
  std::optional<sensors::Sensors> sensors_;
  std::unique_ptr<Pictures> pictures_;
  std::optional<SensorMaps> sensor_maps_;
  Record record_;
  std::optional<Certificate> certificate_;
  std::optional<Checks> checks_;
  std::optional<ResetWatch> reset_;
  const bridge::Options* bridge_options_;
  std::optional<bridge::Bridge> bridge_;
  bool ended_ = false;  // by its partner
  ContactFigures contact_;
  long frame_every_ = 1, steps_ = 0, last_ = 0;  // last_: where this run ends, with --frames before the scene does
  long picture_every_ = 1, checkpoint_steps_ = 0;
  double checkpoint_seconds_ = 0;
  Time::time_point saved_ = Time::now();
  bool started_ = false, stepped_ = false;
  int seen_ = checkpoints_asked();
  std::string budget_;  // how wrong quantities are, JSON
};

}  // namespace

Routine<Exit> run_one(const Options& options, scene::Scene scene, Progress& progress, Turn& turn, std::string* ended_by,
                      const bridge::Options* bridge) {
  Run run(options, std::move(scene), progress, turn, bridge);
  const Exit status = co_await run.go();
  if (ended_by) *ended_by = run.ended_by();
  co_return status;
}

Exit run_scene(const Options& options, std::span<const scene::EffectTable> tables) {
  std::signal(SIGPIPE, SIG_IGN);  // a reader of the progress that went away does not end the run
  scene::Scene scene = scene::read_scene(options.scene, options.overrides, tables);
  const long count = scene::environment_count(scene.root);
  if (!options.together.empty() && count == 0) throw Error(Exit::usage, "--together: the scene has no 'environments'");
  if (options.environment < 0 && count > 0) return run_batch(options, scene, tables);
  const std::unique_ptr<Progress> progress = make_progress(options.json, options.quiet);
  if (is_bridged(options, scene)) {
    check_bridge(options, scene);
    return run_bridged(options, scene, tables, *progress);
  }
  Turn turn;
  Routine<Exit> run =
      options.environment < 0 ? run_one(options, std::move(scene), *progress, turn) : run_environment(options, scene, tables, *progress, turn);
  return run_alone(options, turn, run);
}

}  // namespace mortise::run
