// mortise sweep: one scene, many rows of parameters.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <numeric>

#include "cli/commands.h"
#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "run/run.h"
#include "sweep/run_rows.h"

namespace mortise::cli {
namespace {

struct SweepOptions {
  std::string file, output, shard, device = "auto";
  long index = -1;
  int jobs = 1, threads = 0;
  bool dry_run = false, no_render = false, quiet = false;
  TimeLimits limits;
};

std::string values(const sweep::Row& row) {
  std::string out;
  for (const auto& [path, value] : row.values) out += (out.empty() ? "" : "  ") + path + "=" + value;
  return out;
}

// "2/8": rows 2, 10, 18, ...
std::vector<std::size_t> shard(const std::string& text, std::size_t count) {
  std::size_t part = 0, of = 1;
  if (!text.empty()) {
    int end = 0;
    if (std::sscanf(text.c_str(), "%zu/%zu%n", &part, &of, &end) != 2 || static_cast<std::size_t>(end) != text.size() || of == 0 || part >= of)
      throw Error(Exit::usage, "--shard is '" + text + "'; must be I/N with I from 0 to N - 1");
  }
  std::vector<std::size_t> out;
  for (std::size_t i = part; i < count; i += of) out.push_back(i);
  return out;
}

int run_one(const SweepOptions& o, const sweep::Sweep& s, const std::string& folder) {
  const auto row = static_cast<std::size_t>(o.index);
  if (row >= s.rows.size()) throw Error(Exit::usage, fmt::format("--index {}: the sweep has rows 0 to {}", o.index, s.rows.size() - 1));
  const std::string into = sweep::row_folder(folder, row);
  if (const sweep::Status before = sweep::status_of(into); before.finished()) {
    std::cerr << fmt::format("row {} is finished: there is nothing to do\n", row);
    return before.code;
  }
  run::Options r;
  r.scene = s.scene, r.overrides = s.rows[row].overrides(s.set), r.output = into, r.resume = "auto", r.device = o.device, r.threads = o.threads;
  r.no_render = o.no_render, r.quiet = o.quiet;
  r.walltime = o.limits.walltime, r.grace = o.limits.grace, r.checkpoint_every = o.limits.checkpoint_every;
  return static_cast<int>(run::run_scene(r, engine::effect_tables()));
}

// What the machine, or Slurm, grants this process.
int granted_threads() {
  engine::cpu_api().set_threads(0);
  return engine::cpu_api().devices(nullptr).front().threads;
}

int cmd_sweep(const SweepOptions& o) {
  o.limits.check();
  const sweep::Sweep s = sweep::read_sweep(o.file);
  const std::string folder = o.output.empty() ? "out/" + s.name : o.output;
  sweep::RunOptions r{folder, o.device, o.threads, o.jobs, o.no_render, shard(o.shard, s.rows.size())};
  r.walltime = o.limits.walltime, r.grace = o.limits.grace, r.checkpoint_every = o.limits.checkpoint_every;
  if (o.dry_run) {
    sweep::check_rows(s);
    for (std::size_t row : r.rows) std::cout << fmt::format("{:>4}  {}\n", row, values(s.rows[row]));
    std::cerr << fmt::format("{} of {} rows of {}; every scene is right; results would go to {}\n", r.rows.size(), s.rows.size(), s.scene, folder);
    return 0;
  }
  if (o.index < 0) sweep::check_rows(s);
  sweep::claim_folder(s, folder);
  if (o.index >= 0) return run_one(o, s, folder);
  if (r.threads == 0) r.threads = std::max(1, granted_threads() / o.jobs);
  std::size_t ended = 0;
  std::vector<std::size_t> failed;
  const Exit code = sweep::run_rows(s, r, [&](std::size_t row, const sweep::Status& status, double seconds) {
    ++ended;
    if (!status.finished() && status.is != sweep::Status::Is::stopped) failed.push_back(row);
    if (o.quiet) return;
    std::cerr << fmt::format("{:>4}/{}  row {:04}  {:14}  {:>8}  {}\n", ended, r.rows.size(), row, sweep::name_of(status.is),
                             seconds > 0 ? fmt::format("{:.1f} s", seconds) : "before", values(s.rows[row]));
    if (!status.message.empty() && !status.finished()) std::cerr << "        " << status.message.substr(0, status.message.find('\n')) << "\n";
  });
  std::sort(failed.begin(), failed.end());
  if (!failed.empty())
    std::cerr << fmt::format("{} of {} rows failed: {}; the same command tries them again\n", failed.size(), r.rows.size(), sweep::ranges(failed));
  if (code == Exit::stopped) std::cerr << "stopped; the same command goes on\n";
  if (!o.quiet) std::cerr << fmt::format("'mortise merge {}' gathers the results\n", folder);
  return static_cast<int>(code);
}

}  // namespace

void add_sweep(Command app, Context& context) {
  const Command sub = app.command("sweep", "run one scene with many rows of parameters, one folder per row");
  auto o = std::make_shared<SweepOptions>();
  sub.option("sweep", o->file, "file of the sweep (schemas/sweep.md)").required();
  sub.option("-o,--output", o->output, "folder of the rows' folders; default out/<name of the sweep>");
  const Flag index =
      sub.option("--index", o->index, "only this row, in this process, with the exit code of its run (for array jobs: $SLURM_ARRAY_TASK_ID)")
          .not_negative();
  sub.option("--shard", o->shard, "I/N: only rows I, I + N, I + 2 N, ...").excludes(index);
  sub.flag("--dry-run", o->dry_run, "print the rows and check the scene of each").excludes(index);
  sub.option("-j,--jobs", o->jobs, "rows at once").positive().show_default().excludes(index);
  sub.option("--threads", o->threads, "CPU threads of every row; default: those that the process may use (SLURM_CPUS_PER_TASK) shared out")
      .positive();
  add_device_option(sub, o->device);
  add_time_limits(sub, o->limits);
  sub.flag("--no-render", o->no_render, "no pictures");
  sub.flag("-q,--quiet", o->quiet, "errors only");
  sub.footer(
      "A finished row is never run again; one that was cut short goes on from its checkpoint, one that failed is tried again: the same command until "
      "it ends with 0.\n"
      "Examples:\n  mortise sweep mu.yaml --dry-run\n  mortise sweep mu.yaml -j 8\n  mortise sweep mu.yaml --index 7        (one task of an array; "
      "exit 75: run it again)\n  mortise merge out/mu\n"
      "Exit codes: 0 all rows done, 5 a row failed, 7 checks of a row failed, 75 stopped by a signal or --walltime (run the same again)");
  sub.action([o, &context] { context.action = [o] { return cmd_sweep(*o); }; });
}

}  // namespace mortise::cli
