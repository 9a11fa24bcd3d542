#include "cli/bench_hard.h"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "bench/hard/hard.h"
#include "cli/bench_result.h"

namespace mortise::cli {

void add_hard_flags(Command sub, HardFlags& flags) {
  const Flag quick = sub.flag("--quick", flags.quick, "hard: every case cut to seconds (the default)");
  sub.flag("--full", flags.full, "hard: whole lengths, variants with both contact methods").excludes(quick);
  sub.option("--only", flags.only, "hard: only these cases (H11, or the beginning of a scene's name)").split(',');
  sub.option("--out", flags.output,
             "folder of the figures and pictures of a benchmark (default out/bench/NAME), of the runs of hard and fuzz (default out/hard, out/fuzz)");
  sub.flag("--wild", flags.wild,
           "fuzz: scenes that are not tame: quadratic elements, mesh files, statics, loads, sensors, BDF2, driven bodies, crowds, kills");
  sub.flag("--as-is", flags.as_is, "fuzz: leave scenes that fail as they are; otherwise parts are taken out while they fail in the same way");
  sub.option("--limit", flags.limit, "hard, fuzz: CPU seconds after which a run is ended (default 60, full 3600)").positive();
  sub.option("--expect", flags.expect,
             "hard: exit code 0 when at most three rows that pass in this file (one written by --result) fail and none is unsafe");
  sub.option("--seeds", flags.seeds, "fuzz: how many").show_default();
  sub.option("--first", flags.first_seed, "fuzz: the first seed").show_default();
}

namespace {

// Without the paths of this machine.
nlohmann::ordered_json rows_of(const std::vector<bench::hard::Row>& rows) {
  auto list = nlohmann::ordered_json::array();
  for (const bench::hard::Row& row : rows) {
    list.push_back(nlohmann::ordered_json::parse(bench::hard::json_line(row)));
    list.back().erase("replay");
  }
  return list;
}

int finish(const std::string& name, const std::vector<bench::hard::Row>& rows, const std::string& result, bool json) {
  if (!json) std::cout << bench::hard::summary(rows);
  if (!result.empty()) write_result(result, name, rows_of(rows));
  for (const bench::hard::Row& row : rows)
    if (!row.pass) return static_cast<int>(Exit::solve);
  return static_cast<int>(Exit::done);
}

}  // namespace

int bench_hard(const HardFlags& flags, const std::string& scenes, const std::string& result, int threads, bool json) {
  bench::hard::require_judge();
  bench::hard::Options o;
  o.scenes = scenes, o.output = flags.output.empty() ? "out/hard" : flags.output, o.full = flags.full, o.only = flags.only, o.threads = threads;
  o.time_limit = flags.limit > 0 ? flags.limit : flags.full ? 3600 : 60;
  if (!json) std::cout << bench::hard::table_header() << std::flush;
  const auto rows = bench::hard::run(
      o, [&](const bench::hard::Row& row) { std::cout << (json ? bench::hard::json_line(row) + "\n" : bench::hard::table_line(row)) << std::flush; });
  const int code = finish("hard", rows, result, json);
  if (flags.expect.empty()) return code;
  const std::vector<std::string> worse = bench::hard::regressions(rows, flags.expect, flags.only.empty());
  for (const std::string& line : worse) std::cerr << "worse: " << line << "\n";
  // Some runs are chaotic: the last bits of another machine's BLAS may tip one of them over a limit. Never a safe one into an unsafe one.
  constexpr std::size_t kTipped = 3;
  const bool unsafe = std::any_of(rows.begin(), rows.end(), [](const bench::hard::Row& row) { return !row.unsafe.empty(); });
  return static_cast<int>(unsafe || worse.size() > (flags.only.empty() ? kTipped : 0) ? Exit::solve : Exit::done);
}

int bench_fuzz(const HardFlags& flags, const std::string& result, int threads, bool json) {
  bench::hard::require_judge();
  bench::hard::Options o;
  o.output = flags.output.empty() ? "out/fuzz" : flags.output, o.threads = threads, o.reduce = !flags.as_is,
  o.time_limit = flags.limit > 0 ? flags.limit : 60;
  if (!json) std::cout << bench::hard::table_header() << std::flush;
  o.wild = flags.wild;
  if (flags.wild && flags.limit <= 0) o.time_limit = 20;
  const auto rows = bench::hard::run_fuzz(o, flags.first_seed, flags.seeds, [&](const bench::hard::Row& row) {
    std::cout << (json ? bench::hard::json_line(row) + "\n" : bench::hard::table_line(row));
    if (!row.pass && !json) std::cout << "    " << row.replay << "\n";
    std::cout << std::flush;
  });
  if (!json) std::cout << bench::hard::causes(rows);
  return finish(flags.wild ? "fuzz_wild" : "fuzz", rows, result, json);
}

}  // namespace mortise::cli
