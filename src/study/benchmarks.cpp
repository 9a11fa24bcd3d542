// Studies of benchmarks: rows of one combination come from one call, method by method, with the benchmark's own references.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/sha256.h"
#include "base/version.h"
#include "bench/benchmark.h"
#include "engine/choose.h"
#include "output/atomic_file.h"
#include "output/json_number.h"
#include "run/signals.h"
#include "study/compare.h"
#include "study/run_study.h"

namespace fs = std::filesystem;

namespace mortise::study {
namespace {

using Json = nlohmann::ordered_json;

double number_of(const Json& j) { return j.is_number() ? j.get<double>() : NAN; }

// What a study needs of a benchmark's row.
struct Line {
  std::string name, method, quantity;
  double value, error, seconds, slowest;
  long newton, dofs;
  bool failed;
  bool is(const std::string& wanted) const { return quantity == wanted || name + ": " + quantity == wanted; }
};

std::vector<Line> lines_of(const Json& j) {
  std::vector<Line> out;
  for (const Json& r : j["rows"])
    out.push_back({r["case"], r["method"], r["quantity"], number_of(r["value"]), number_of(r["error"]), number_of(r["seconds"]),
                   number_of(r["slowest"]), r["newton_iterations"], r["dofs"], r["failed"]});
  return out;
}

// The rows of FOLDER/runs/<id>.json, or of a run of the benchmark that is written there.
std::vector<Line> rows(const Study& study, const bench::Benchmark& benchmark, const Planned& run, const Place& place, RunResult& result) {
  std::vector<std::string> sets = study.set;
  for (const auto& [key, value] : run.settings) sets.push_back(key + "=" + value);
  const std::string build = std::string(version()) + " " + git_sha1();
  std::string all =
      study.benchmark + place.device + std::to_string(place.threads) + std::to_string(study.repeats) + bench::benchmark_scene(study.benchmark);
  for (const std::string& s : sets) all += "\n" + s;
  result.id = sha256(all).substr(0, 12), result.label = run.label;
  const std::string path = place.folder + "/runs/" + result.id + ".json";
  if (fs::exists(path))
    if (const Json before = Json::parse(output::read_file(path), nullptr, false); before.is_object() && before.value("version", "") == build) {
      result.before = true, result.load = before.value("load", 0.0);
      return lines_of(before);
    }
  Json out = Json::array();
  result.load = load_average();
  for (int i = 0; i < study.repeats; ++i) {
    std::size_t at = 0;
    bench::run_benchmark(benchmark, sets,
                         {[&](const bench::Row& r) {
                            if (run::stop_asked()) throw Error(Exit::stopped, "stopped; the same command goes on");
                            const double cost = std::isfinite(r.cpu_seconds) && place.device != "cuda" ? r.cpu_seconds : r.seconds;
                            if (i == 0)
                              out.push_back({{"case", r.name},
                                             {"method", r.method},
                                             {"quantity", r.quantity},
                                             {"value", output::number_or_null(r.value)},
                                             {"error", output::number_or_null(r.error)},
                                             {"seconds", output::number_or_null(cost)},
                                             {"slowest", output::number_or_null(cost)},
                                             {"newton_iterations", r.newton_iterations},
                                             {"dofs", r.dofs},
                                             {"failed", r.failed}});
                            else if (at < out.size())  // they come in the same order
                              out[at]["seconds"] = output::number_or_null(std::min(number_of(out[at]["seconds"]), cost)),
                              out[at]["slowest"] = output::number_or_null(std::max(number_of(out[at]["slowest"]), cost));
                            ++at;
                          },
                          {},
                          {}});
  }
  result.load = std::max(result.load, load_average());
  const Json record{{"filetype", "mortise study benchmark"}, {"version", build}, {"label", run.label}, {"load", result.load}, {"rows", out}};
  output::write_file_atomically(path, json_text(record, 1) + "\n", false);
  return lines_of(record);
}

}  // namespace

Results run_benchmark_study(const Study& study, const Place& place, const Told& told) {
  const Plan plan = plan_of(study);
  engine::choose(place.device, place.threads);
  const bench::Benchmark& benchmark = *bench::find_benchmark(study.benchmark);
  Results out;
  out.study = study;
  out.references.resize(study.quantities.size());
  for (Reference& r : out.references) r.value = NAN, r.uncertainty = 0, r.how = "the benchmark's own";
  for (const Curve& curve : plan.curves)
    for (std::size_t i = 0; i < curve.runs.size(); ++i) {
      const Planned& planned = plan.runs[curve.runs[i]];
      RunResult result;
      result.values.assign(study.quantities.size(), NAN);
      const std::size_t before = out.points.size();
      for (const Line& row : rows(study, benchmark, planned, place, result))
        for (std::size_t k = 0; k < study.quantities.size(); ++k) {
          if (!row.is(study.quantities[k].value)) continue;
          Point p;
          p.curve = row.method + (curve.name.empty() || row.method.empty() ? "" : ", ") + curve.name,
          p.label = row.method + (row.method.empty() ? "" : ", ") + planned.label, p.run = result.id;
          p.settings = planned.settings, p.quantity = k, p.step = i, p.value = row.value, p.error = row.error, p.seconds = row.seconds,
          p.slowest = row.slowest;
          p.newton = row.newton, p.dofs = row.dofs, p.failed = row.failed, p.why = row.failed ? "did not converge" : "";
          result.values[k] = row.value, result.seconds = row.seconds, result.newton = row.newton, result.dofs = row.dofs;
          out.points.push_back(p);
        }
      if (out.points.size() == before)
        throw Error(Exit::usage, study.quantities.front().place,
                    "benchmark '" + study.benchmark + "' has no such quantity (a row's quantity, or 'case: quantity'); 'mortise bench " +
                        study.benchmark + "' shows what it has");
      told.run(out.runs.size() + 1, plan.runs.size(), result);
      out.runs.push_back(std::move(result));
    }
  // Curve by curve, each in the order of its ladder.
  std::vector<std::string> order;
  for (const Point& p : out.points)
    if (!std::count(order.begin(), order.end(), p.curve)) order.push_back(p.curve);
  std::stable_sort(out.points.begin(), out.points.end(), [&](const Point& a, const Point& b) {
    return std::find(order.begin(), order.end(), a.curve) < std::find(order.begin(), order.end(), b.curve);
  });
  mark_best(out.points, out.references);
  describe_machine(place, out);
  return out;
}

}  // namespace mortise::study
