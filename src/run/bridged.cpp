#include "run/bridged.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/json_text.h"
#include "bridge/bridge.h"
#include "bridge/tuning.h"
#include "run/alone.h"
#include "run/folder.h"
#include "run/progress.h"
#include "run/run.h"
#include "scene/environments.h"

namespace fs = std::filesystem;

namespace mortise::run {
namespace {

std::string recording_in(const std::string& folder) { return folder + "/" + bridge::kRecordingFile; }

bool exists(const std::string& path) {
  std::error_code ec;
  return fs::exists(path, ec);
}

std::string folder_of_episode(const std::string& first, long episode) { return episode == 0 ? first : episode_folder(first, episode); }

void refuse(const Options& o, const scene::Scene& scene) {
  const auto wrong = [](const std::string& what) { throw Error(Exit::usage, what); };
  const long count = scene::environment_count(scene.root);
  if (count > 0 && o.environment < 0) {
    if (o.bridge == "-")
      wrong("--bridge - drives one environment: name one of the scene's " + std::to_string(count) +
            " with --environment, or give a command, of which each gets a partner of its own");
    if (!o.together.empty()) wrong("--together: environments with partners run as processes; leave --together out");
    if (!o.replay.empty() && !fs::is_directory(o.replay)) wrong("--replay of all environments needs the output folder of a run, not a recording");
  }
  if (o.bridge == "-" && o.scene == "-") wrong("--bridge - takes the standard input, from which the scene would come; give the scene as a file");
  if (o.bridge == "-" && o.json) wrong("--bridge - takes the standard output, where --json would write");
}

// The recording that an episode repeats; none where there are no more.
std::string replayed(const std::string& replay, long episode) {
  if (!fs::is_directory(replay)) return episode == 0 ? replay : "";
  const std::string path = recording_in(folder_of_episode(replay, episode));
  if (episode == 0 && !exists(path)) throw Error(Exit::file, "--replay: '" + replay + "' has no " + bridge::kRecordingFile);
  return exists(path) ? path : "";
}

class Session {
 public:
  Session(const Options& o, const scene::Scene& all, std::span<const scene::EffectTable> tables, bridge::Partner* partner, Progress& progress)
      : o_(o), all_(all), tables_(tables), partner_(partner), first_(folder_of(o, all.root)), progress_(progress) {}

  Exit go() {
    if (o_.environment >= 0 && all_.root.at("environments").has("reset")) progress_.note("environments.reset is not watched: the partner says when");
    for (long episode = 0;; ++episode) {
      Options one = o_;
      one.output = folder_of_episode(first_, episode);
      if (episode > 0 && !one.resume.empty()) one.resume = "auto";
      bridge::Options bridge{partner_, o_.replay.empty() ? "" : replayed(o_.replay, episode), o_.bridge_every, episode, o_.environment};
      if (episode > 0 && !partner_ && bridge.replay.empty() && !exists(recording_in(one.output))) return last_;
      Turn turn;
      Routine<Exit> run = run_one(one, scene_of(episode), progress_, turn, nullptr, &bridge);
      last_ = run_alone(one, turn, run);
      if ((last_ != Exit::done && last_ != Exit::checks) || !bridge::Recording::read(recording_in(one.output)).ends_with("reset")) return last_;
    }
  }

 private:
  scene::Scene scene_of(long episode) const {
    return o_.environment < 0 ? all_ : scene::one_environment(all_, o_.overrides, tables_, o_.environment, std::max(o_.episode, 0L) + episode);
  }

  const Options& o_;
  const scene::Scene& all_;
  std::span<const scene::EffectTable> tables_;
  bridge::Partner* partner_;
  const std::string first_;
  Progress& progress_;
  Exit last_ = Exit::done;
};

}  // namespace

bool is_bridged(const Options& o, const scene::Scene& scene) {
  return !o.bridge.empty() || !o.replay.empty() || (!o.resume.empty() && exists(recording_in(folder_of(o, scene.root))));
}

void check_bridge(const Options& o, const scene::Scene& scene) {
  if (!o.bridge.empty() || !o.replay.empty()) refuse(o, scene);
}

Exit run_bridged(const Options& o, const scene::Scene& scene, std::span<const scene::EffectTable> tables, Progress& progress) {
  std::optional<bridge::Partner> partner;
  if (!o.bridge.empty()) partner.emplace(o.bridge, o.bridge_timeout < 0 ? bridge::kTimeout : o.bridge_timeout);
  const auto farewell = [&](Exit code, const std::string& message) {
    nlohmann::ordered_json j{{"end", code == Exit::done || code == Exit::checks ? "done"
                                     : code == Exit::stopped                    ? "stopped"
                                                                                : "failed"},
                             {"exit_code", static_cast<int>(code)}};
    if (!message.empty()) j["message"] = message;
    if (partner) partner->say(json_text(j));
  };
  try {
    const Exit code = Session(o, scene, tables, partner ? &*partner : nullptr, progress).go();
    farewell(code, "");
    return code;
  } catch (const Error& e) {
    farewell(e.code(), e.what());
    throw;
  }
}

}  // namespace mortise::run
