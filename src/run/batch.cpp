#include "run/batch.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/choose.h"
#include "engine/input.h"
#include "output/atomic_file.h"
#include "run/alone.h"
#include "run/batch_files.h"
#include "run/batch_progress.h"
#include "run/batch_share.h"
#include "run/batch_verdict.h"
#include "run/bridged.h"
#include "run/earlier.h"
#include "run/environment.h"
#include "run/environment_end.h"
#include "run/environment_process.h"
#include "run/folder.h"
#include "run/progress.h"
#include "run/record.h"
#include "run/signals.h"
#include "run/together.h"
#include "run/tuning.h"
#include "scene/environments.h"

namespace mortise::run {
namespace {

using Time = std::chrono::steady_clock;

class Batch {
 public:
  Batch(const Options& o, const scene::Scene& scene, std::span<const scene::EffectTable> tables)
      : o_(o),
        scene_(scene),
        tables_(tables),
        name_(scene.root.text("name")),
        folder_(folder_of(o, scene.root)),
        progress_(o.json, o.quiet),
        ends_(scene::environment_count(scene.root)) {}

  Exit go() {
    prepare();
    int seen = checkpoints_asked();
    while (next_ < count() || !running_.empty()) {
      if (stop()) pass_stop_on();
      while (!stopping_ && next_ < count() && share_.any_free()) launch();
      if (checkpoint_asked(seen))
        for (const auto& p : running_) p->signal(SIGUSR1);
      listen();
    }
    return finish();
  }

 private:
  long count() const { return static_cast<long>(ends_.size()); }
  double since_begin() const { return std::chrono::duration<double>(Time::now() - begin_).count(); }
  bool stop() const { return stop_asked() || (o_.walltime > 0 && since_begin() > o_.walltime - o_.grace); }

  void prepare() {
    check_bridge(o_, scene_);
    if (!o_.together.empty()) check_together(scene_);
    if (o_.resume == "yes" && !folder_.exists())
      throw Error(Exit::file, "--resume: there is no folder '" + folder_.path() + "' (use --resume=auto to start afresh then)");
    if (const std::string taken = folder_.lock(); !taken.empty()) progress_.note(taken);
    if (folder_.used() && o_.resume.empty()) {
      if (!o_.overwrite)
        throw Error(Exit::usage,
                    "'" + folder_.path() + "' is not empty; use --overwrite to replace its results, --resume to continue, or another -o");
      folder_.remove_results();
    }
    for (long e = 0; e < count() && !o_.resume.empty(); ++e)  // one speaks for all
      if (is_of_environment(environment_folder(folder_.path(), e), scene_, o_, tables_, e)) break;
    std::filesystem::remove(folder_.file("run.json"));  // written last: this run has not ended
    for (long e = 0; e < count(); ++e) ends_[e].drawn = scene::draw(scene_.root, e, 0);
    write_table();

    // A GPU is not shared; whether it would be one must be found out elsewhere, because its driver does not stand copies of the process.
    std::string why;
    const bool may_be_gpu = o_.device != "cpu" && o_.device != "debug" && engine::cuda_api(why);
    const bool gpu = may_be_gpu && asked_aside([this] { return engine::choose(o_.device, o_.threads).device.kind == "cuda" ? 0 : 1; }) == 0;
    engine::cpu_api().set_threads(o_.threads);
    record_.device = engine::cpu_api().devices(nullptr).front();
    threads_ = record_.device.threads;
    share_ = BatchShare(group(gpu), threads_, gpu);
    engine::cpu_api().set_threads(1);  // copies of this process have to find no threads
    const auto meshing = Time::now();
    engine::keep_meshes(scene_.root);
    record_.seconds["setup"] = std::chrono::duration<double>(Time::now() - meshing).count();
    install_signal_handlers();
    const Params& time = scene_.root.at("time");
    const long all = time.integer("steps"), steps = o_.frames >= 0 ? std::min<long>(all, o_.frames * time.integer("frame_every")) : all;
    progress_.start(name_,
                    fmt::format("{} environment{}, {}; {} steps each; results in {}", count(), count() == 1 ? "" : "s", share_.text(count()), steps,
                                folder_.path()),
                    count(), steps);
  }

  // How many environments share a model: on a GPU all, where they can.
  long group(bool gpu) {
    if (o_.together == "all") return count();
    if (o_.together == "auto") return gpu ? count() : std::min(tuning::kTogether, count());
    if (!o_.together.empty()) return std::min(std::stol(o_.together), count());
    if (!gpu) return 1;
    try {
      check_together(scene_);
      return count();
    } catch (const Error& e) {
      progress_.note(std::string("one environment after the other: ") + e.what());
      return 1;
    }
  }

  Options options_of(long e, int threads, std::size_t in_turn) const {
    Options one = o_;
    one.environment = e;
    one.output = environment_folder(folder_.path(), e);
    one.threads = threads, one.in_turn = static_cast<long>(in_turn);
    if (!one.resume.empty()) one.resume = "auto";
    if (one.walltime > 0) one.walltime = std::max(one.walltime - since_begin(), 1e-9);
    const std::string& drawn = scene_.root.at("environments").text("pictures");
    if (!one.replay.empty()) one.replay = environment_folder(o_.replay, e);
    one.no_render = one.no_render || drawn == "none" || (drawn == "first" && e > 0);
    return one;
  }

  void launch() {
    const int threads = share_.take(count() - next_);
    std::vector<long> which;
    while (next_ < count() && static_cast<long>(which.size()) < share_.group()) which.push_back(next_++);
    running_.push_back(std::make_unique<EnvironmentProcess>(which, threads, [this, &which, threads] { run_here(which, threads); }));
  }

  // In the process of these environments.
  void run_here(const std::vector<long>& which, int threads) const {
    Together together;
    for (long e : which) together.options.push_back(options_of(e, threads, which.size())), together.progress.push_back(make_progress_of(e));
    together.ended = [&](std::size_t i, const EnvironmentEnd& end) { tell_end(which[i], end); };
    if (which.size() > 1) return run_together(together, scene_, tables_);
    const Options& one = together.options[0];
    EnvironmentEnd end;
    try {
      if (is_bridged(one, scene_)) {
        end.code = static_cast<int>(run_bridged(one, scene_, tables_, *together.progress[0]));
      } else {
        Turn turn;
        Routine<Exit> run = run_environment(one, scene_, tables_, *together.progress[0], turn);
        end.code = static_cast<int>(run_alone(one, turn, run));
      }
    } catch (const Error& e) {
      end.code = static_cast<int>(e.code()), end.message = e.what();
    }
    tell_end(which[0], end);
  }

  void listen() {
    std::vector<pollfd> pipes;
    for (const auto& p : running_) pipes.push_back({p->pipe(), POLLIN, 0});
    constexpr int kMilliseconds = 50;  // how long a signal waits at most
    if (poll(pipes.data(), pipes.size(), kMilliseconds) <= 0) return;
    for (std::size_t i = 0; i < pipes.size(); ++i) {
      if (pipes[i].revents == 0) continue;
      EnvironmentProcess& p = *running_[i];
      const auto ended = [this](long e) {
        read_end(environment_folder(folder_.path(), e), ends_[e]);
        progress_.ended(e, ends_[e]);
      };
      if (p.listen([this](long e, const std::string& line) { hear(e, line); }, ended, ends_)) continue;
      share_.give_back(p.threads());
      running_[i].reset();
    }
    std::erase(running_, nullptr);
  }

  // What all environments would say is said once.
  void hear(long e, const std::string& line) {
    const bool note = line.rfind("{\"event\":\"note\"", 0) == 0,
               own = line.rfind("{\"event\":\"step\"", 0) == 0 || line.rfind("{\"event\":\"frame\"", 0) == 0;
    if (note || own) progress_.event(e, line);
    if (!note || o_.json) return;
    const std::string text = text_of(line);
    if (text.find("warning: ") == 0 && said_.insert(text).second) progress_.note(fmt::format("environment {}: {}", e, text));
    if (text.find("check failed: ") == 0) progress_.note(fmt::format("environment {}: {}", e, text));
  }

  void pass_stop_on() {
    if (!stopping_ && stop_asked())
      for (const auto& p : running_) p->signal(SIGTERM);
    stopping_ = true;
    if (running_.empty()) next_ = count();
  }

  void write_table() const { output::write_file_atomically(folder_.file("environments.csv"), environments_csv(ends_), true); }

  // What sums the environments up.
  Exit finish() {
    const BatchVerdict verdict = verdict_of(ends_, folder_.file("environments.csv"));
    BatchEnd end{name_,
                 scene::identity(scene_.root),
                 static_cast<long>(scene_.root.at("environments").integer("seed")),
                 threads_,
                 verdict.code,
                 verdict.message,
                 0};
    write_batch_files(scene_.root, folder_.path(), ends_, !o_.no_render);
    end.wall = since_begin();
    write_table();
    output::write_file_atomically(folder_.file("environments.json"), environments_json(ends_, end), true);
    for (const EnvironmentEnd& e : ends_) record_.frames += e.frames;
    record_.write(folder_.file("run.json"), {o_, name_, end.scene_sha256, end.code, end.message, end.wall}, nullptr);
    if (end.code == Exit::stopped) {
      progress_.note(fmt::format("stopped with {} of {} environments finished; continue with --resume", count() - verdict.unfinished, count()));
    } else if (verdict.failed > 0) {
      throw Error(end.code, end.message);
    } else {
      double cpu = 0;
      for (const EnvironmentEnd& e : ends_) cpu += e.cpu;
      progress_.end(fmt::format("{}: {} environment{}, {} of CPU time", end.code == Exit::done ? "done" : end.message, count(),
                                count() == 1 ? "" : "s", duration_text(cpu)),
                    end.wall);
    }
    if (progress_.lost())
      throw Error(Exit::file, "the standard output could not be written to the end; the results in '" + folder_.path() + "' are complete");
    return end.code;
  }

  static std::string text_of(const std::string& line);

  const Options& o_;
  const scene::Scene& scene_;
  std::span<const scene::EffectTable> tables_;
  const std::string name_;
  Folder folder_;
  BatchProgress progress_;
  Record record_;
  Time::time_point begin_ = Time::now();
  std::vector<EnvironmentEnd> ends_;
  std::vector<std::unique_ptr<EnvironmentProcess>> running_;
  std::set<std::string> said_;
  long next_ = 0;
  int threads_ = 1;
  BatchShare share_;
  bool stopping_ = false;
};

std::string Batch::text_of(const std::string& line) {
  const auto event = nlohmann::json::parse(line, nullptr, false);
  return event.is_object() ? event.value("text", "") : "";
}

}  // namespace

Exit run_batch(const Options& options, const scene::Scene& scene, std::span<const scene::EffectTable> tables) {
  return Batch(options, scene, tables).go();
}

}  // namespace mortise::run
