#include "run/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "output/atomic_file.h"
#include "run/earlier.h"
#include "run/environment_end.h"
#include "run/folder.h"
#include "run/run.h"
#include "run/tuning.h"
#include "scene/environments.h"
#include "scene/quantity.h"

namespace fs = std::filesystem;

namespace mortise::run {
namespace {

constexpr const char* kLog = "episodes.csv";

std::string first_line_quoted(const std::string& text) {
  std::string out;
  for (char c : text.substr(0, text.find('\n'))) out += c == '"' ? "\"\"" : std::string(1, c);
  return "\"" + out + "\"";
}

class Episodes {
 public:
  Episodes(const Options& o, const scene::Scene& all, std::span<const scene::EffectTable> tables, Progress& progress, Turn& turn)
      : o_(o),
        all_(all),
        tables_(tables),
        progress_(progress),
        turn_(turn),
        folder_(folder_of(o, all.root)),
        conditions_(all.root.at("environments").at("reset").items()) {}

  Routine<Exit> go() {
    prepare();
    Exit worst = Exit::done;
    for (bool more = true; more && taken() < total_;) {
      const Exit code = co_await next(more);
      if (code == Exit::stopped) co_return code;
      if (code != Exit::done) worst = code;
    }
    co_return worst;
  }

 private:
  void prepare() {
    const Params& time = all_.root.at("time");
    total_ = static_cast<long>(time.integer("steps"));
    if (o_.frames >= 0) total_ = std::min(total_, o_.frames * static_cast<long>(time.integer("frame_every")));
    if (const std::string taken_over = folder_.lock(); !taken_over.empty()) progress_.note(taken_over);
    if (o_.resume.empty() && folder_.used()) {
      if (!o_.overwrite)
        throw Error(Exit::usage,
                    "'" + folder_.path() + "' is not empty; use --overwrite to replace its results, --resume to continue, or another -o");
      folder_.remove_results();
    }
    if (!o_.resume.empty()) is_of_environment(folder_.path(), all_, o_, tables_, o_.environment);
    done_ = episodes_in(folder_.path());
  }

  long taken() const { return done_.empty() ? 0 : done_.back().first_step + done_.back().steps; }
  bool survives(Exit code) const {
    return (code == Exit::solve || code == Exit::scene) &&
           std::any_of(conditions_.begin(), conditions_.end(), [](const Params& c) { return c.has("failure"); });
  }

  // Runs one; `more`: a condition ended it.
  Routine<Exit> next(bool& more) {
    Options one = o_;
    one.episode = static_cast<long>(done_.size());
    one.output = episode_folder(folder_.path(), one.episode);
    one.resets = conditions_;
    one.most_steps = total_ - taken();
    one.frames = -1;
    if (!one.resume.empty()) one.resume = "auto";
    Exit code = Exit::done;
    std::string why;
    long failed = 0;
    try {
      code = co_await run_one(one, scene::environment_of(all_, o_.overrides, tables_, o_.environment, one.episode), progress_, turn_, &why);
    } catch (const Error& e) {
      if (!survives(e.code())) throw;
      why = std::string("failure: ") + e.what(), failed = 1;
    }
    if (code == Exit::stopped) co_return code;
    EnvironmentEnd end;
    read_run(one.output, end);
    write(one.episode, end.steps + failed, why);
    more = !why.empty();
    co_return code;
  }

  void write(long episode, long steps, const std::string& why) {
    Episode e{taken(), steps, ""};
    e.line = fmt::format("{},{},{},{}", episode, e.first_step, e.steps, first_line_quoted(why));
    for (const scene::Drawn& d : scene::draw(all_.root, o_.environment, episode)) e.line += "," + scene::format_number(d.value);
    done_.push_back(std::move(e));
    if (done_.size() == tuning::kOddEpisodes && std::all_of(done_.begin(), done_.end(), [](const Episode& d) { return d.steps <= 1; }))
      progress_.note(fmt::format("warning: its first {} episodes all ended with their first step: {}", done_.size(), why));
    std::string text = episodes_header(all_.root) + "\n";
    for (const Episode& d : done_) text += d.line + "\n";
    output::write_file_atomically(folder_.file(kLog), text, true);
  }

  const Options& o_;
  const scene::Scene& all_;
  std::span<const scene::EffectTable> tables_;
  Progress& progress_;
  Turn& turn_;
  Folder folder_;
  const std::vector<Params> conditions_;
  std::vector<Episode> done_;
  long total_ = 0;
};

}  // namespace

std::string episodes_header(const Params& scene) {
  std::string out = "episode,first_step,steps,ended_by";
  for (const scene::Drawn& d : scene::draw(scene, 0, 0)) out += "," + d.path;
  return out;
}

std::vector<Episode> episodes_in(const std::string& folder) {
  std::vector<Episode> out;
  const std::string path = folder + "/" + kLog;
  std::error_code ec;
  if (!fs::exists(path, ec)) return out;
  std::istringstream in(output::read_file(path));
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    Episode e;
    long number = 0;
    if (std::sscanf(line.c_str(), "%ld,%ld,%ld,", &number, &e.first_step, &e.steps) != 3 || number != static_cast<long>(out.size()))
      throw Error(Exit::file, "'" + path + "' is damaged; --overwrite begins afresh");
    e.line = line;
    out.push_back(std::move(e));
  }
  return out;
}

Routine<Exit> run_environment(const Options& o, const scene::Scene& all, std::span<const scene::EffectTable> tables, Progress& progress, Turn& turn) {
  const scene::Scene one = scene::one_environment(all, o.overrides, tables, o.environment, std::max(o.episode, 0L));
  if (o.episode < 0 && all.root.at("environments").has("reset")) {
    Episodes episodes(o, all, tables, progress, turn);
    co_return co_await episodes.go();
  }
  co_return co_await run_one(o, one, progress, turn);
}

}  // namespace mortise::run
