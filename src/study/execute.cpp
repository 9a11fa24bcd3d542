#include "study/execute.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/process.h"
#include "base/sha256.h"
#include "base/version.h"
#include "output/atomic_file.h"
#include "output/json_number.h"
#include "run/signals.h"
#include "study/measure.h"

namespace fs = std::filesystem;

namespace mortise::study {
namespace {

using Json = nlohmann::ordered_json;

Json read_json(const std::string& path) { return fs::exists(path) ? Json::parse(output::read_file(path), nullptr, false) : Json(); }

double number(const Json& j, const char* block, const char* key) {
  return j.is_object() && j.contains(block) && j[block].is_object() && j[block].contains(key) && j[block][key].is_number()
             ? j[block][key].get<double>()
             : NAN;
}

constexpr int kTooLong = 128 + SIGXCPU;

// Ends that would be the same again: results, steps that fail, scenes that are refused, and times that were too long (more of it is tried again).
bool final(const Json& record, const Most& most) {
  const int code = record.value("code", -1);
  const auto no_more = [&](const char* key, double now) { return now > 0 && now <= record.value(key, 0.0); };
  if (code == kTooLong) return no_more("limit", most.steps) || no_more("process_limit", most.process);
  for (Exit e : {Exit::done, Exit::checks, Exit::solve, Exit::scene})
    if (code == static_cast<int>(e)) return true;
  return false;
}

// A run that ended by itself is kept as it is, whatever it may take this time.
RunResult judged(RunResult run, const Most& most) {
  if (!run.failed() && most.steps > 0 && run.seconds > most.steps)
    run.code = kTooLong, run.message = fmt::format("took more than {:g} s of CPU time in its steps: {:.3g} s", most.steps, run.seconds);
  return run;
}

// Degrees of freedom: three per node of a soft body, twelve per stiff one.
long dofs(const output::FieldReader& file) {
  std::vector<bool> soft(file.mesh().body_names.size(), false);
  for (std::size_t c = 0; c < file.mesh().cells(); ++c)
    if (file.mesh().types[c] != output::CellType::triangle) soft[file.mesh().body_of_cell[c]] = true;
  long n = 0;
  for (int body : file.mesh().body_of_point) n += soft[body] ? 3 : 0;
  return n + 12 * static_cast<long>(std::count(soft.begin(), soft.end(), false));
}

std::string first_line(const std::string& text) {
  const std::string line = text.substr(0, text.find('\n'));
  const std::size_t at = line.find("error: ");
  return at == std::string::npos ? line : line.substr(at + 7);
}

RunResult from(const Json& record) {
  RunResult out;
  out.id = record["id"], out.label = record["label"], out.code = record["code"], out.message = record["message"];
  const auto value = [&](const char* key) { return record[key].is_number() ? record[key].get<double>() : NAN; };
  out.seconds = value("seconds"), out.slowest = value("slowest"), out.process = value("process_seconds"), out.load = value("load");
  out.newton = record["newton_iterations"], out.dofs = record["dofs"], out.grade = record["grade"];
  return out;
}

}  // namespace

double load_average() {
  double load = 0;
  return getloadavg(&load, 1) == 1 ? load : 0;
}

RunResult execute(const Planned& run, const Place& place, int repeats, const Most& most) {
  const std::string id = sha256(run.variant.id + place.device + std::to_string(place.threads) + std::to_string(repeats)).substr(0, 12);
  const std::string stem = place.folder + "/runs/" + id, version = std::string(mortise::version()) + " " + git_sha1();
  if (const Json before = read_json(stem + ".json"); before.is_object() && before.value("version", "") == version && final(before, most)) {
    RunResult found = from(before);
    found.before = true, found.label = run.label;
    return judged(found, most);
  }
  output::write_file_atomically(stem + ".yaml", "# " + run.label + "\n" + run.variant.yaml, false);
  RunResult out;
  Over over = Over::none;
  out.id = id, out.label = run.label;
  for (int i = 0; i < repeats; ++i) {
    out.load = std::max(out.load, load_average());
    const std::vector<std::string> command{own_program(), "run",     stem + ".yaml", "-o",         stem,        "--overwrite",
                                           "--no-render", "--quiet", "--device",     place.device, "--threads", std::to_string(place.threads)};
    std::error_code none;
    fs::remove(stem + "/fields.vtkhdf", none);
    const Ended ended = run_limited(command, stem + ".log", most, stem + "/fields.vtkhdf");
    out.load = std::max(out.load, load_average());
    over = ended.over;
    out.code = over == Over::none ? ended.code : kTooLong, out.process += ended.cpu;
    if (ended.code == static_cast<int>(Exit::stopped) || run::stop_asked()) throw Error(Exit::stopped, "stopped; the same command goes on");
    const Json said = read_json(stem + "/run.json");
    const bool gpu = said.is_object() && said.contains("device") && said["device"].value("kind", "") == "cuda";
    double cost = number(said, gpu ? "seconds" : "cpu_seconds", "solve");
    if (cost == 0) cost = number(said, "seconds", "solve");  // shorter than the clock's ticks
    if (!std::isfinite(cost)) cost = ended.cpu;              // it ended before its first step
    out.seconds = i == 0 ? cost : std::min(out.seconds, cost), out.slowest = i == 0 ? cost : std::max(out.slowest, cost);
    if (said.is_object() && said.contains("steps") && said["steps"].contains("newton_iterations") && said["steps"]["newton_iterations"].is_object())
      out.newton = static_cast<long>(said["steps"]["newton_iterations"].value("total", 0.0));
    if (ended.code == static_cast<int>(Exit::file))  // a full disk says nothing about the settings
      throw Error(Exit::file,
                  "a run could not be written: " + first_line(output::read_file(stem + ".log")) + "\n  the same command goes on when there is room");
    if (out.failed()) {
      out.message = over == Over::steps     ? fmt::format("took more than {:g} s of CPU time in its steps", most.steps)
                    : over == Over::process ? fmt::format("took more than {:.3g} s of CPU time", most.process)
                    : said.is_object()      ? first_line(said.value("message", ""))
                                            : first_line(output::read_file(stem + ".log"));
      if (out.message.empty())
        out.message = ended.code > 128 ? fmt::format("ended by signal {}", ended.code - 128) : fmt::format("exit code {}", ended.code);
      break;
    }
  }
  if (!out.failed()) {
    out.dofs = dofs(output::FieldReader(stem + "/fields.vtkhdf"));
    const Json certificate = read_json(stem + "/certificate.json");
    if (certificate.is_object()) out.grade = certificate.value("grade", "");
  }
  const Json record{{"filetype", "mortise study run"},
                    {"version", version},
                    {"id", id},
                    {"label", run.label},
                    {"code", out.code},
                    {"message", out.message},
                    {"seconds", output::number_or_null(out.seconds)},
                    {"slowest", output::number_or_null(out.slowest)},
                    {"process_seconds", out.process},
                    {"load", out.load},
                    {"repeats", repeats},
                    {"limit", over == Over::steps ? most.steps : 0},
                    {"process_limit", over == Over::process ? most.process : 0},
                    {"newton_iterations", out.newton},
                    {"dofs", out.dofs},
                    {"grade", out.grade}};
  output::write_file_atomically(stem + ".json", json_text(record, 1) + "\n", false);
  return judged(out, most);
}

void measure_all(const Study& study, const Place& place, RunResult& result, bool may_be_gone) {
  result.values.assign(study.quantities.size(), NAN);
  if (result.failed()) return;
  const output::FieldReader file(place.folder + "/runs/" + result.id + "/fields.vtkhdf");
  for (std::size_t k = 0; k < study.quantities.size(); ++k) try {
      result.values[k] = measure(file, study.quantities[k]);
    } catch (const Error& e) {
      if (!may_be_gone || e.code() != Exit::usage) throw;
    }
}

}  // namespace mortise::study
