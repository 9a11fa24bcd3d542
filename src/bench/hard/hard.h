#pragma once
// `mortise bench hard`: the scenes of scenes/hard, each run by the program itself in a process of its own, so that a crash or an endless
// loop is a row of the table like any other failure. A row passes when the run ends as its scene says, every criterion of the scene holds
// and mortise_judge finds nothing in the saved states.
//
// A scene may hold, under the key `x-hard` (which `mortise run` passes over):
//   mortar:    the mortar_contact block that replaces barrier_contact in the mortar variant; absent: there is none
//   mortar_checks: further checks of that variant
//   full:      --set values of a full run
//   variants:  name -> list of --set values: runs beside the base, with barrier_contact (full: with mortar_contact as well)
//   reported:  barrier | mortar -> list of quantities that the method does not claim to hold (the catalogue asks them of others); they are
//              measured, and a row that misses nothing else is "reported", neither passed nor failed
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace mortise::bench::hard {

struct Options {
  std::string scenes;             // folder; empty: scenes/hard, searched upwards from here and from the program
  std::string output;             // folder of the runs
  bool full = false;              // whole lengths and all variants; otherwise each case is cut to seconds
  std::vector<std::string> only;  // case ids or beginnings of scene names; empty: all
  int threads = 0;
  double time_limit = 120;  // of a run [CPU s]
  bool wild = false;        // fuzz: scenes that are not tame
  bool reduce = true;       // fuzz: take parts out of scenes that fail
};

struct Row {
  std::string name, method, variant;
  long steps = 0, newton_max = 0, halved = 0;
  double newton_mean = NAN, min_distance = NAN, min_det_f = NAN, energy_gain = NAN, residual = NAN, seconds = NAN;
  bool pass = false, judged = false;
  std::string reason;                      // what failed first; empty when it passed
  std::string missed;                      // criteria that the method does not claim to hold, with their figures
  long intersections = 0, not_finite = 0;  // in saved states, by the judge
  std::string unsafe;  // what may never be: intersections, values that are not finite, crashes, steps that only seem to converge, no judgement
  std::string replay;  // one command
};

// mortise_judge has to lie beside this program. Throws Error(Exit::file) that says how to build it.
void require_judge();

// Runs them; rows come as they are measured. Throws Error(Exit::usage | Exit::file).
std::vector<Row> run(const Options& options, const std::function<void(const Row&)>& emit);

std::string json_line(const Row& row);  // one line
std::string table_header();
std::string table_line(const Row& row);
std::string summary(const std::vector<Row>& rows);

// --- parts ---

// A scene to run: text, and what to call it.
struct Case {
  std::string name, method, variant, text;
  bool expects_failure = false;          // its checks hold an outcome other than done
  std::vector<std::string> reported{};   // quantities without a verdict
  std::string may_stop{};                // words of an error with which a run may rightly end: such a row is reported
  std::vector<std::string> arguments{};  // further ones of `mortise run`
  bool interrupted = false;              // run once more, killed on the way and resumed: the fields must be equal
};
// The cases of one scene file.
std::vector<Case> cases_of(const std::string& path, bool full);

struct Ended {
  int code = -1;       // exit code; 128 + signal; -1: over the time limit
  double seconds = 0;  // of CPU time
};
// Runs one; options.output must be absolute.
Row run_case(const Case& c, const Options& options);

// --- expectations ---

// What became worse than in a file written by --result: rows that passed and do not (running out of time apart), that are not in the file, and
// whatever is unsafe. `all`: rows of the file that were not run count too. Throws Error(Exit::file).
std::vector<std::string> regressions(const std::vector<Row>& rows, const std::string& file, bool all);

// --- fuzzer ---

// A random scene: primitives, materials, contact effects, time steps and scales from a seed, with the common checks of the hard cases.
Case fuzz_case(unsigned long seed);
// One that is not tame: quadratic and curved elements, mesh files (written into `folder`), statics, sensors, loads, BDF2, driven bodies, many
// bodies, both contact effects, every linear solver, the debug device, a kill in the middle.
Case wild_case(unsigned long seed, const std::string& folder);
// What failed, without figures and names: failures of one kind have equal causes.
std::string cause(const Row& row);
// How many rows failed for which cause, and which; the most frequent first. "" where all passed.
std::string causes(const std::vector<Row>& rows);
// Takes parts out of a scene that failed for as long as it fails in the same way; returns the file with what is left.
std::string reduce(const Case& failed, const Row& row, const Options& options);
// Runs the seeds first ... first + count - 1. A row that failed names the reduced scene in `replay`.
std::vector<Row> run_fuzz(const Options& options, unsigned long first, unsigned long count, const std::function<void(const Row&)>& emit);

// Runs a program without a shell; stdout and stderr go to files. Ends it when it takes more than `limit` seconds of CPU time.
Ended run_program(const std::vector<std::string>& arguments, const std::string& out, const std::string& err, double limit);

}  // namespace mortise::bench::hard
