#include "study/run_study.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/version.h"
#include "output/hardware.h"
#include "run/signals.h"
#include "study/budget.h"
#include "study/compare.h"
#include "study/corrections.h"

namespace fs = std::filesystem;

namespace mortise::study {

StudyFolder::StudyFolder(const std::string& path) : lock_(path + "/study.lock") {
  std::error_code ec;
  fs::create_directories(path + "/runs", ec);
  if (ec) throw Error(Exit::file, "cannot create '" + path + "/runs': " + ec.message());
  descriptor_ = open(lock_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw Error(Exit::file, "cannot write into '" + path + "'");
  if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor_);
    throw Error(Exit::file, "another study is writing into '" + path + "'; use another -o, or wait");
  }
}

StudyFolder::~StudyFolder() {
  unlink(lock_.c_str());
  close(descriptor_);
}

void describe_machine(const Place& place, Results& r) {
  const output::Hardware h = output::hardware();
  r.cpu = h.cpu, r.cores = h.cores, r.device = place.device, r.threads = place.threads;
  r.version = std::string(version()) + (*git_sha1() ? std::string(" (") + git_sha1() + ")" : "");
  for (const RunResult& run : r.runs) r.load = std::max(r.load, run.load);
}

Results run_study(const Study& study, const Place& place, const Told& told) {
  run::install_signal_handlers();
  if (study.budget > 0) return run_with_budget(study, place, told);
  if (!study.benchmark.empty()) return run_benchmark_study(study, place, told);
  Plan plan = plan_of(study);
  Results out;
  out.study = study;
  std::map<std::string, RunResult> by_scene;  // equal scenes are run once
  std::size_t all = 0;
  for (const Planned& p : plan.runs) by_scene.try_emplace(p.variant.id), all = by_scene.size();
  for (const Planned& p : plan.runs) {
    RunResult& result = by_scene[p.variant.id];
    if (result.id.empty()) {
      result = execute(p, place, study.repeats, {study.limit});
      measure_all(study, place, result);
      told.run(static_cast<std::size_t>(std::count_if(by_scene.begin(), by_scene.end(), [](const auto& r) { return !r.second.id.empty(); })), all,
               result);
    }
    out.runs.push_back(result);
    out.runs.back().label = p.label;
  }
  if (std::all_of(out.runs.begin(), out.runs.end(), [](const RunResult& r) { return r.failed(); }))
    throw Error(Exit::solve, "every run failed, the first with: " + out.runs.front().message);
  // How knobs interact: a run with all of them finer.
  const bool limits = std::any_of(study.quantities.begin(), study.quantities.end(), [](const Quantity& q) { return !q.reference; });
  if (const std::vector<OnCurve> steps = joint_steps(plan, out); limits && !steps.empty()) {
    const Planned joint = joint_run(study, plan, steps);
    RunResult result = execute(joint, place, study.repeats, {study.limit});
    measure_all(study, place, result);
    told.run(all + 1, all + 1, result);
    plan.refined.push_back({plan.runs.size(), steps});
    plan.runs.push_back(joint), out.runs.push_back(result);
  }
  RunResult over;
  const bool needed = !study.over_resolved.empty() && needs_over_resolved(plan, out);
  if (needed) {
    Planned run{0, over_resolved(study), label_of(study.over_resolved)};
    run.variant = variant_of(study, study.methods.front(), run.settings);
    over = execute(run, place, 1, {});
    measure_all(study, place, over);
    told.run(all + 1, all + 1, over);
  }
  compare(plan, needed ? &over : nullptr, out);
  if (needed && over.failed()) out.notes.push_back("the over-resolved run failed: " + over.message);
  if (needed) out.runs.push_back(over);
  describe_machine(place, out);
  return out;
}

}  // namespace mortise::study
