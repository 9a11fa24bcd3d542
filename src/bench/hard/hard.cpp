#include "bench/hard/hard.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/json_text.h"
#include "base/process.h"
#include "output/json_number.h"

namespace fs = std::filesystem;

namespace mortise::bench::hard {
namespace {

using Json = nlohmann::ordered_json;
using Time = std::chrono::steady_clock;

std::string judge_program() { return (fs::path(own_program()).parent_path() / "mortise_judge").string(); }

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// scenes/hard in the nearest folder above here or above the program.
std::string find_scenes() {
  for (fs::path from : {fs::current_path(), fs::path(own_program()).parent_path()})
    for (; from.has_relative_path(); from = from.parent_path())
      if (fs::is_directory(from / "scenes/hard")) return (from / "scenes/hard").string();
  throw Error(Exit::usage, "found no folder scenes/hard; give it with --data DIR");
}

bool wanted(const std::string& name, const std::vector<std::string>& only) {
  const auto lower = [](std::string s) {
    for (char& c : s) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return s;
  };
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& o) { return name.starts_with(lower(o)); });
}

double number(const Json& j, const char* key) { return j.contains(key) && j[key].is_number() ? j[key].get<double>() : NAN; }

// The first line of an error message.
std::string first_error(const std::string& err) {
  std::size_t at = err.find("error: ");
  if (at == std::string::npos) return "";
  at += 7;
  return err.substr(at, err.find('\n', at) - at);
}

constexpr double kMostWaiting = 20;  // times the CPU seconds that are allowed: a program that takes so long in all hangs

// How a run ended, in a few words.
std::string ending(const Ended& end, const std::string& err, double limit) {
  if (end.code == -1) return fmt::format("not done after {:.0f} CPU s", limit);
  if (end.code >= 128) return fmt::format("ended by signal {}", end.code - 128);
  return fmt::format("exit code {}: {}", end.code, first_error(err));
}

bool begins_with_any(const std::string& text, const std::vector<std::string>& heads) {
  return std::any_of(heads.begin(), heads.end(), [&](const std::string& h) { return text.starts_with(h + " "); });
}

// Reads certificate.json; tells what is wrong with the run, "" if nothing.
std::string read_certificate(const std::string& dir, const Case& asked, const Ended& end, Row& row) {
  const Json j = Json::parse(read_text(dir + "/certificate.json"), nullptr, false);
  if (j.is_discarded()) return "no certificate";
  const Json &solver = j["solver"], &invariants = j["invariants"];
  row.steps = solver["steps"], row.newton_max = solver["newton_iterations_max"], row.halved = solver["halved_steps"];
  row.newton_mean = number(solver, "newton_iterations_mean");
  row.residual = number(solver, "residual_over_tolerance_max");
  row.min_distance = number(invariants, "min_distance_m"), row.min_det_f = number(invariants, "min_det_F");
  row.energy_gain = number(invariants, "energy_gain_relative");
  std::string wrong;
  const auto say = [&](const std::string& what) {
    if (wrong.empty()) wrong = what;
  };
  const bool finished = end.code == 0 || end.code == static_cast<int>(Exit::checks);  // failed criteria are told one by one below
  const std::string ended = fmt::format("exit code {}: {}", end.code, first_error("error: " + j["message"].get<std::string>()));
  if (!finished && !asked.may_stop.empty() && ended.find(asked.may_stop) != std::string::npos)
    row.missed = ended;
  else if (!finished && !asked.expects_failure)
    say(ended);
  const bool refused = asked.expects_failure && end.code == static_cast<int>(Exit::scene);  // then the first state may touch
  if (invariants["not_finite_values"] != 0 && !refused) say(row.unsafe = "not finite: " + j["reason"].get<std::string>());
  if (row.residual > 1) say(row.unsafe = fmt::format("a step ended at {:.3g} times its tolerance", row.residual));
  for (const Json& c : j.value("criteria", Json::array())) {
    const std::string text = c["criterion"];
    if (c["pass"].is_null() || c["pass"].get<bool>() || (!row.missed.empty() && c["value"].is_null()))
      continue;  // what rightly stopped at once measured nothing
    const std::string miss = text + ": " +
                             (c["value"].is_number()   ? fmt::format("{:.4g}", c["value"].get<double>())
                              : c["value"].is_string() ? c["value"].get<std::string>()
                                                       : "not measured");
    if (begins_with_any(text, asked.reported))
      row.missed += (row.missed.empty() ? "" : "; ") + miss;
    else
      say(miss);
  }
  return wrong;
}

// A run refused before there was a folder for it has no certificate: its outcome is in the exit code and the message.
std::string refused(const Case& c, const Ended& end, const std::string& err) {
  if (!c.expects_failure || end.code != static_cast<int>(Exit::scene)) return "refused: " + first_error(err);
  return "";
}

// The judge's opinion of the saved states; "" where nothing was found. A run that was killed may leave a file that cannot be read.
std::string judge(const std::string& dir, bool killed, Row& row) {
  const std::string program = judge_program(), fields = dir + "/fields.vtkhdf";
  if (!fs::exists(fields)) return "";
  if (!fs::exists(program)) return row.unsafe = "not judged: no program " + program;
  const Ended end = run_program({program, fields}, dir + "/judge.json", dir + "/judge.err", 120);
  const Json j = Json::parse(read_text(dir + "/judge.json"), nullptr, false);
  if (j.is_discarded()) return killed ? "" : row.unsafe = "the judge cannot read the fields: " + read_text(dir + "/judge.err");
  row.judged = true;
  row.intersections = j["intersections"].get<long>() + j["below_planes"].get<long>(), row.not_finite = j["not_finite"];
  if (end.code == 0) return "";
  const std::string found = fmt::format("judge: {} (frame {})", j["what"].get<std::string>(), j["first_frame"].get<long>());
  if (row.intersections + row.not_finite > 0) row.unsafe = found;
  return found;
}

// The same run killed at some moment and resumed; what differs from the fields in `dir`, "" if nothing. The moment depends on the scene alone,
// as far as the machine repeats itself.
std::string interrupt(std::vector<std::string> arguments, const std::string& dir, const std::string& text, double seconds, double limit) {
  const std::string again = dir + "_resumed", err = again + ".err";
  *(std::find(arguments.begin(), arguments.end(), "-o") + 1) = again;
  fs::remove_all(again);
  const double fraction = 0.3 + 0.6 * static_cast<double>(std::hash<std::string>{}(text) % 1000) / 1000;
  if (run_program(arguments, "/dev/null", err, fraction * seconds).code != -1) fs::remove_all(again);  // it was faster this time: nothing to resume
  arguments.push_back("--resume=auto");
  const Ended end = run_program(arguments, "/dev/null", err, limit);
  if (end.code != 0) return "resumed: " + ending(end, read_text(err), limit);
  const Ended compared = run_program({judge_program(), dir + "/fields.vtkhdf", again + "/fields.vtkhdf"}, again + ".diff", err, limit);
  return compared.code == 0 ? "" : "resumed: the fields are not equal: " + read_text(again + ".diff");
}

const char* verdict(const Row& r) { return !r.pass ? "fails" : r.missed.empty() ? "pass" : "reported"; }

std::string cell(double v) { return std::isfinite(v) ? fmt::format("{:.3g}", v) : "-"; }

}  // namespace

Row run_case(const Case& c, const Options& o) {
  Row row;
  row.name = c.name, row.method = c.method, row.variant = c.variant;
  std::string label = c.name;
  for (const std::string& part : {c.method, c.variant})
    if (!part.empty()) label += "-" + part;
  for (char& ch : label)
    if (!std::isalnum(static_cast<unsigned char>(ch)) && ch != '.' && ch != '-') ch = '_';
  const std::string scene = o.output + "/" + label + ".yaml", dir = o.output + "/" + label;
  std::ofstream(scene) << c.text;
  row.replay = fmt::format("{} run {} --overwrite --no-render -o {}", own_program(), scene, dir);
  fs::remove_all(dir);
  std::vector<std::string> arguments{own_program(), "run", scene, "--no-render", "--quiet", "-o", dir};
  if (o.threads > 0) arguments.insert(arguments.end(), {"--threads", std::to_string(o.threads)});
  arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
  const std::string err_file = scene + ".err";
  const Ended end = run_program(arguments, "/dev/null", err_file, o.time_limit);
  const std::string err = read_text(err_file);
  fs::remove(err_file);
  row.seconds = end.seconds;
  if (end.code < 0 || end.code >= 128)
    row.reason = ending(end, err, o.time_limit);
  else if (fs::exists(dir + "/certificate.json"))
    row.reason = read_certificate(dir, c, end, row);
  else
    row.reason = refused(c, end, err);
  if (end.code >= 128 || end.code == static_cast<int>(Exit::internal)) row.unsafe = row.reason;
  const std::string judged = end.code == static_cast<int>(Exit::scene) ? "" : judge(dir, end.code < 0, row);
  if (row.reason.empty()) row.reason = judged;
  if (row.reason.empty() && row.missed.empty() && c.interrupted)
    row.reason = row.unsafe = interrupt(arguments, dir, c.text, end.seconds, o.time_limit);
  row.pass = row.reason.empty();
  return row;
}

Ended run_program(const std::vector<std::string>& arguments, const std::string& out, const std::string& err, double limit) {
  const auto begin = Time::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Time::now() - begin).count(); };
  const pid_t child = start_program(arguments, out, err);
  clockid_t clock;
  const bool counts = clock_getcpuclockid(child, &clock) == 0;
  int status = 0;
  rusage used{};
  for (auto wait = std::chrono::milliseconds(1); wait4(child, &status, WNOHANG, &used) == 0;
       wait = std::min(2 * wait, std::chrono::milliseconds(50))) {
    timespec now{};
    const bool over = counts && clock_gettime(clock, &now) == 0 && static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) > limit;
    if (over || elapsed() > kMostWaiting * limit) {
      kill(child, SIGKILL);
      wait4(child, &status, 0, &used);
      return {-1, cpu_seconds(used)};
    }
    std::this_thread::sleep_for(wait);
  }
  return {code_of(status), cpu_seconds(used)};
}

void require_judge() {
  if (fs::exists(judge_program())) return;
  throw Error(Exit::file,
              "there is no program '" + judge_program() +
                  "', which judges the saved states\n  it is built with the tests ('tools/mortise' leaves them out): 'tools/test -N' builds "
                  "everything and runs no test; then use build/test/bin/mortise");
}

std::vector<Row> run(const Options& options, const std::function<void(const Row&)>& emit) {
  Options o = options;
  if (o.scenes.empty()) o.scenes = find_scenes();
  if (!fs::is_directory(o.scenes)) throw Error(Exit::file, "'" + o.scenes + "' is not a folder");
  fs::create_directories(o.output);
  o.output = fs::absolute(o.output).string();
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(o.scenes))
    if (entry.path().extension() == ".yaml" && wanted(entry.path().filename().string(), o.only)) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw Error(Exit::usage, "no scene of " + o.scenes + " is wanted");
  std::vector<Row> rows;
  for (const std::string& file : files)
    for (const Case& c : cases_of(file, o.full)) {
      rows.push_back(run_case(c, o));
      if (emit) emit(rows.back());
    }
  return rows;
}

std::string json_line(const Row& r) {
  return json_text(Json{{"case", r.name},
                        {"method", r.method},
                        {"variant", r.variant},
                        {"verdict", verdict(r)},
                        {"pass", r.pass},
                        {"reason", r.reason},
                        {"reported", r.missed},
                        {"judged", r.judged},
                        {"intersections", r.intersections},
                        {"not_finite", r.not_finite},
                        {"unsafe", r.unsafe},
                        {"steps", r.steps},
                        {"newton_max", r.newton_max},
                        {"newton_mean", output::number_or_null(r.newton_mean)},
                        {"halved_steps", r.halved},
                        {"min_distance", output::number_or_null(r.min_distance)},
                        {"min_det_f", output::number_or_null(r.min_det_f)},
                        {"energy_gain", output::number_or_null(r.energy_gain)},
                        {"residual", output::number_or_null(r.residual)},
                        {"seconds", output::number_or_null(r.seconds)},
                        {"replay", r.replay}});
}

std::string table_header() {
  return fmt::format("{:22} {:8} {:14} {:>5} {:>10} {:>9} {:>9} {:>9} {:>8} {:>7} {:>8}  {}\n", "case", "method", "variant", "steps", "newton",
                     "distance", "det F", "gain", "residual", "seconds", "verdict", "reason");
}

std::string table_line(const Row& r) {
  return fmt::format("{:22} {:8} {:14} {:>5} {:>10} {:>9} {:>9} {:>9} {:>8} {:>7.1f} {:>8}  {}\n", r.name, r.method, r.variant, r.steps,
                     fmt::format("{}/{:.1f}", r.newton_max, r.newton_mean), cell(r.min_distance), cell(r.min_det_f), cell(r.energy_gain),
                     cell(r.residual), r.seconds, verdict(r), r.reason.empty() ? r.missed : r.reason);
}

std::string summary(const std::vector<Row>& rows) {
  long passed = 0, reported = 0, judged = 0, unsafe = 0;
  double seconds = 0;
  for (const Row& r : rows)
    passed += r.pass && r.missed.empty(), reported += r.pass && !r.missed.empty(), judged += r.judged, unsafe += !r.unsafe.empty(),
        seconds += r.seconds;
  return fmt::format("{} of {} pass, {} more miss only what their method does not claim, {} fail; {} judged independently, {} unsafe; {:.0f} s\n",
                     passed, rows.size(), reported, rows.size() - passed - reported, judged, unsafe, seconds);
}

}  // namespace mortise::bench::hard
