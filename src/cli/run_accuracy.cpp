#include "cli/run_accuracy.h"

#include <fmt/format.h>
#include <sys/wait.h>

#include <filesystem>
#include <iostream>

#include "base/process.h"
#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "output/atomic_file.h"
#include "run/folder.h"
#include "study/accuracy.h"
#include "study/report.h"
#include "study/run_study.h"
#include "study/variant.h"

namespace mortise::cli {
namespace {

namespace fs = std::filesystem;

// The files of a run of the search become those of the output folder; on one disk they are kept once.
void publish(const std::string& from, const std::string& to) {
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) {
    if (!entry.is_regular_file()) continue;
    const fs::path target = fs::path(to) / entry.path().filename();
    std::error_code ec;
    fs::remove(target, ec);
    fs::create_hard_link(entry.path(), target, ec);
    if (ec && !fs::copy_file(entry.path(), target, fs::copy_options::overwrite_existing, ec))
      throw Error(Exit::file, "cannot write '" + target.string() + "': " + ec.message());
  }
}

// In a process, as nothing else of a search is drawn here. What it says goes to our standard error.
void draw(const std::string& scene, const std::string& folder) {
  const pid_t child = start_program({own_program(), "render", scene, folder + "/fields.vtkhdf"}, "/dev/stderr", "/dev/stderr");
  int status = 0;
  waitpid(child, &status, 0);
  if (code_of(status) != 0) std::cerr << "note: pictures could not be drawn; the results are complete\n";
}

}  // namespace

int run_to_accuracy(const run::Options& o, const std::vector<std::string>& goals, double most) {
  study::Wanted wanted{o.scene, o.overrides, {}, most};
  for (const std::string& g : goals) wanted.goals.push_back(study::goal_of_flag(g));
  if (o.walltime > 0 || o.checkpoint_every > 0 || !o.together.empty())
    throw Error(Exit::usage, "--accuracy excludes --walltime, --checkpoint-every and --together: what was run is not run again by the same command");
  if (o.scene == "-") throw Error(Exit::usage, "--accuracy reads the scene many times; give a file, not the standard input");
  const scene::Scene scene = scene::read_scene(o.scene, o.overrides, engine::effect_tables());
  const std::string to = run::folder_of(o, scene.root);
  if (!o.overwrite && (fs::exists(to + "/fields.vtkhdf") || fs::exists(to + "/run.json")))
    throw Error(Exit::usage, "'" + to + "' has results; use --overwrite to replace them, or another -o");
  const study::StudyFolder lock(to + "/accuracy");
  const study::Place place{to + "/accuracy", o.device == "auto" ? "cpu" : o.device, o.threads > 0 ? o.threads : 1};
  const study::Accuracy found = study::find_accuracy(wanted, place, [&](const study::Attempt& a, const std::vector<study::Quantity>& quantities) {
    if (o.quiet) return;
    std::string text = fmt::format("{:44} {:>10}", a.run.label, study::seconds_text(a.run.process));
    for (std::size_t q = 0; q < quantities.size() && !a.run.failed(); ++q) text += fmt::format("  {} {:.6g}", quantities[q].name, a.run.values[q]);
    if (a.run.failed()) text += "  " + a.run.message;
    std::cerr << text << (a.run.before ? " (before)" : "") << "\n";
  });
  run::Folder folder(to);
  folder.lock();
  folder.remove_results();
  const std::string chosen = to + "/accuracy/runs/" + found.attempts[found.chosen].run.id;
  publish(chosen, to);
  output::write_file_atomically(to + "/accuracy.json", study::accuracy_json(found), false);
  study::Study study;
  study.scene = o.scene, study.set = o.overrides, study.methods.emplace_back();
  output::write_file_atomically(
      to + "/accurate.yaml",
      "# " + found.attempts[found.chosen].run.label + "\n" + study::variant_of(study, study.methods.front(), found.settings, true).yaml, false);
  if (!o.no_render && scene.root.has("render")) draw(to + "/accurate.yaml", to);
  std::cout << study::accuracy_table(found) << "written to " << to
            << ": the results of the run marked *, accuracy.json, accurate.yaml (the scene with its settings)\n";
  return static_cast<int>(found.reached ? static_cast<Exit>(found.attempts[found.chosen].run.code) : Exit::checks);
}

}  // namespace mortise::cli
