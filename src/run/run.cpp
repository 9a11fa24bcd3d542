#include "run/run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <optional>

#include "base/memory_archive.h"
#include "base/shell.h"
#include "base/version.h"
#include "bridge/bridge.h"
#include "cost/predict.h"
#include "engine/input.h"
#include "output/atomic_file.h"
#include "output/checkpoint.h"
#include "output/run_json.h"
#include "run/alone.h"
#include "run/batch.h"
#include "run/bridged.h"
#include "run/checkpoint_times.h"
#include "run/earlier.h"
#include "run/environment.h"
#include "run/folder.h"
#include "run/progress.h"
#include "run/record.h"
#include "run/reported.h"
#include "run/reset_watch.h"
#include "run/results.h"
#include "run/signals.h"
#include "run/stopwatch.h"
#include "run/warnings.h"
#include "scene/environments.h"
#include "sensors/sensors.h"

namespace mortise::run {
namespace {

using Time = std::chrono::steady_clock;

void check(const engine::Outcome& outcome) {
  if (outcome.code != 0) throw Error(static_cast<Exit>(outcome.code), outcome.message, outcome.located);
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
      checkpoint = open_checkpoint(o_, dir, scene_.root, hash_);
      // Of an episode it is not said there which condition ended it: that is looked up once more.
      if (checkpoint && checkpoint->reader.info().step >= last_ && o_.resets.empty())
        if (const auto code = output::code_of_finished_run(folder_->file("run.json"), hash_)) {
          note(fmt::format("the run in '{}' is finished: there is nothing to continue", dir));
          co_return *code;
        }
    } else if (o_.resume == "yes") {
      throw Error(Exit::file, "--resume: there is no folder '" + dir + "' (use --resume=auto to start afresh then)");
    }

    model::ModelInput input = engine::make_input(scene_.root);
    if (o_.environment >= 0) input.scene.set("environments", Params::make_table());  // whose scene has lost the block: solver::Options::batch
    const engine::Outcome made = co_await turn_.engine(input, engine_);
    record_.device = turn_.device;
    note(turn_.said);
    check(made);
    sensors_.emplace(input);
    if (bridge_options_) bridge_.emplace(*bridge_options_, input, *sensors_);
    note(folder_->lock());
    if (!checkpoint) clear_folder(o_, *folder_);
    if (bridge_) note(bridge_->begin(folder_->path(), hash_, checkpoint ? checkpoint->reader.info().step : 0, last_, checkpoint != nullptr));
    results_.emplace(o_, scene_.root, hash_, input, *folder_, *sensors_, record_);
    checkpoints_.emplace(scene_.root, o_.checkpoint_every, o_.in_turn);
    if (!o_.resets.empty()) reset_.emplace(o_.resets, input);
    record_.spent("setup", setup_);
    progress_.start(scene_.root.text("name"), summary(input), steps_);
    for (const std::string& w : warnings(input)) note("warning: " + w);

    install_signal_handlers();
    if (checkpoint)
      go_on(*checkpoint);
    else
      begin(input);

    while (engine_->steps_done() < last_ && !(reset_ && reset_->due())) {
      if (stop()) co_return stopped();
      if (bridge_ && bridge_->due(engine_->steps_done())) {
        const auto answer = hear();
        if (!answer) co_return stopped();
        if (ended_ = *answer != bridge::Bridge::Answer::go_on; ended_) break;
      }
      const engine::Outcome outcome = co_await turn_.step(*engine_, [this] { return stop(); });
      const solver::StepReport report = turn_.report;
      record_.spent("solve", turn_.wall, turn_.cpu);
      if (outcome.code == static_cast<int>(Exit::stopped)) co_return stopped();
      if (outcome.code != 0) fail(outcome, report);
      results_->tried(report);
      stepped_ = true;
      after_step(report);
    }
    if (bridge_ && !ended_) note(bridge_->ask_last(engine_->steps_done(), [this] { return stop(); }));
    if (ended_) save();
    results_->close();
    estimate(input);
    if (!ended_by().empty()) note("reset: " + ended_by());
    if (!checkpoint) keep_time(input);
    co_return Exit::done;
  }

  void go_on(output::NewestCheckpoint& checkpoint) {
    for (const std::string& why : checkpoint.skipped) note(why);
    check(engine_->checkpoint(checkpoint.reader));
    checkpoint_others(checkpoint.reader);
    if (bridge_) engine_->command(bridge_->commands());
    results_->go_on(checkpoint.reader, resolved_);
    started_ = true;
    const bool longer = checkpoint.reader.info().scene_sha256 != hash_;
    note(fmt::format("continuing at step {}, t = {:.6g} s{}", engine_->steps_done(), engine_->time(),
                     longer ? fmt::format(", to step {} instead of {}", steps_, checkpoint.reader.info().steps) : ""));
  }

  void begin(const model::ModelInput& input) {
    started_ = true;
    results_->begin(input, resolved_);
    const std::vector<double> points = engine_->points();
    Snapshot state;
    engine_->report(state);
    if (bridge_) tell(state, points);
    results_->state({engine_->time(), state, points, nullptr, true});
    check_quantities(input, state);
    progress_.frame(0, 0);
    save();
  }

  // What the user is told of a step that failed, and left for it. The checkpoint is of the time before: whoever goes on from it tries the step anew.
  [[noreturn]] void fail(const engine::Outcome& outcome, const solver::StepReport& report) {
    const auto code = static_cast<Exit>(outcome.code);
    const std::string& dir = folder_->path();
    if (code == Exit::solve) save();
    results_->tried(report);
    if (code == Exit::solve) {
      const std::string replay = fmt::format("mortise run {} -o {} --resume --frames {}", shell_word(o_.scene), shell_word(dir),
                                             (engine_->steps_done() + frame_every_) / frame_every_);
      throw Error(code, outcome.message + "\n  the last good state is in " + dir + "/checkpoint.h5; this replays the moment:\n    " + replay +
                            overrides_text());
    }
    if (!outcome.picture.empty()) {
      const std::string picture = folder_->file("touching.obj");
      output::write_file_atomically(picture, outcome.picture, true);
      throw Error(code, outcome.message + "\n  where they touch is drawn in " + picture);
    }
    if (code == Exit::device && output::has_checkpoint(dir))
      throw Error(code, outcome.message + "\n  the last checkpoint in " + dir +
                            " is good: --resume continues from it, on a device with more memory or with less contact");
    throw Error(code, outcome.message, outcome.located);
  }

  // Errors are of the state that a step of this process led to: the next process has no equations of it.
  void estimate(const model::ModelInput& input) {
    if (engine_->steps_done() < last_step() || !o_.estimate || !scene_.root.has("quantities")) return;
    estimated_ = o_.estimate(stepped_ ? engine_.get() : nullptr, input, folder_->file("fields.vtkhdf"));
    for (const std::string& warning : estimated_.warnings) note(warning);
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
    const long step = engine_->steps_done();
    const bool frame = step % frame_every_ == 0 || step == last_step();
    results_->state({engine_->time(), state, points, &report, frame});
    progress_.step(report, results_->contact());
    if (step == last_ || step == last_step() || checkpoints_->due(step, frame) || checkpoint_asked(seen_)) save();
    if (frame) progress_.frame(results_->frames() - 1, engine_->time());
  }

  void watch(Snapshot state, const std::vector<double>& points) {
    sensors_->read(state, points);
    if (engine_->steps_done() == 0) reset_->check(state);
    reset_->see(engine_->steps_done(), engine_->time(), state, points);
  }

  bool stop() const {
    return stop_asked() || (o_.walltime > 0 && std::chrono::duration<double>(Time::now() - begin_).count() > o_.walltime - o_.grace);
  }

  // The last step of all has a frame; so has the one that ends an episode.
  long last_step() const { return reset_ && reset_->due() ? engine_->steps_done() : o_.most_steps >= 0 ? last_ : steps_; }

  // The field file first, so that a checkpoint never speaks of frames that are not there.
  void save() {
    const Stopwatch checkpoint;
    results_->flush();
    output::CheckpointWriter writer(folder_->path(), {version(), hash_, engine_->steps_done(), results_->frames(), engine_->time(), steps_});
    check(engine_->checkpoint(writer));
    results_->checkpoint(writer);
    checkpoint_others(writer);
    writer.commit();
    checkpoints_->saved(checkpoint.wall());
    record_.spent("checkpoint", checkpoint);
  }

  // What neither the engine nor the results have.
  void checkpoint_others(Archive& archive) {
    if (reset_) {
      PrefixedArchive reset(archive, "run/reset");
      reset_->checkpoint(reset);
    }
    if (bridge_) {
      PrefixedArchive bridge(archive, "run/bridge");
      bridge_->checkpoint(bridge);
    }
  }

  Exit stopped() {
    save();
    results_->close();
    note(fmt::format("stopped after step {}; continue with --resume", engine_->steps_done()));
    return Exit::stopped;
  }

  // Returns the code that the program ends with.
  Exit finish(Exit status, const std::string& message) {
    if (!started_) return status;
    Results::End end{status, message, std::chrono::duration<double>(Time::now() - begin_).count(), engine_.get(), estimated_};
    results_->finish(
        end, [this](const std::string& text) { note(text); }, [this](const std::string& text) { progress_.fault(text); });
    if (end.status == Exit::done || end.status == Exit::checks) progress_.end(end.status == Exit::done ? "done" : end.message, end.wall, end.grade);
    return end.status;
  }

  const Options& o_;
  Progress& progress_;
  Turn& turn_;
  Time::time_point begin_ = Time::now();
  Stopwatch setup_;
  scene::Scene scene_;
  std::string resolved_, hash_;
  std::optional<Folder> folder_;
  std::unique_ptr<engine::Engine> engine_;
  std::optional<sensors::Sensors> sensors_;
  Record record_;
  std::optional<Results> results_;
  std::optional<CheckpointTimes> checkpoints_;
  std::optional<ResetWatch> reset_;
  const bridge::Options* bridge_options_;
  std::optional<bridge::Bridge> bridge_;
  bool ended_ = false;                           // by its partner
  long frame_every_ = 1, steps_ = 0, last_ = 0;  // last_: where this run ends, with --frames before the scene does
  bool started_ = false, stepped_ = false;
  int seen_ = checkpoints_asked();
  Estimated estimated_;
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
  install_checkpoint_handler();
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
