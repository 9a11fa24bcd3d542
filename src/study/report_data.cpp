// points.csv and study.json.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/csv_cell.h"
#include "base/json_text.h"
#include "output/json_number.h"
#include "study/compare.h"
#include "study/report.h"
#include "study/tuning.h"

namespace mortise::study {
namespace {

using Json = nlohmann::ordered_json;
using output::number_or_null;

const char* status(const Point& p) { return p.failed ? "failed" : p.reference ? "reference" : p.hollow ? "below_uncertainty" : "done"; }

std::string settings_text(const Settings& s) {
  std::string out;
  for (const auto& [path, value] : s) out += (out.empty() ? "" : "; ") + path + "=" + value;
  return out;
}

}  // namespace

std::string points_csv(const Results& r) {
  std::string out =
      "curve,settings,quantity,value,reference,uncertainty,error,cpu_seconds,cpu_seconds_slowest,newton_iterations,dofs,status,reason,cancelling,"
      "pareto,knee,"
      "run\n";
  for (const Point& p : r.points) {
    const Reference& ref = r.references[p.quantity];
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_cell(p.curve), csv_cell(settings_text(p.settings)),
                       csv_cell(r.study.quantities[p.quantity].name), csv_cell(p.value), csv_cell(ref.value), csv_cell(ref.uncertainty),
                       csv_cell(p.error), csv_cell(p.seconds), csv_cell(p.slowest), p.newton, p.dofs, status(p), csv_cell(p.why), csv_cell(p.cancel),
                       p.best ? 1 : 0, p.knee ? 1 : 0, p.run);
  }
  return out;
}

std::string study_json(const Results& r) {
  Json j{{"filetype", "mortise study"}, {"version", {1, 0}}, {"name", r.study.name}, {"mortise_version", r.version}};
  j["scene"] = r.study.scene, j["benchmark"] = r.study.benchmark, j["set"] = r.study.set;
  j["plan"] = r.study.one_at_a_time ? "one_at_a_time" : "combinations";
  j["machine"] = {{"cpu", r.cpu},
                  {"cores", r.cores},
                  {"device", r.device},
                  {"threads", r.threads},
                  {"largest_load_average", number_or_null(r.load)},
                  {"repeats", r.study.repeats}};
  j["cost"] = r.device == "cuda" ? "wall seconds of the steps"
                                 : "CPU seconds (user and system, all threads) of the steps, without setup and output; of the fastest repeat";
  j["quantities"] = Json::array();
  for (std::size_t k = 0; k < r.study.quantities.size(); ++k) {
    const Reference& ref = r.references[k];
    Json curves = Json::object();
    for (const auto& [name, points] : curves_of(r.points, k)) {
      Json times = Json::object();
      for (double e : tuning::kSameErrors)
        if (const double t = time_at(points, e); std::isfinite(t) && !(e < ref.uncertainty / ref.scale)) times[fmt::format("{:g}", e)] = t;
      if (!times.empty()) curves[name] = times;
    }
    Json shares = Json::array();
    for (const Share& s : r.shares)
      if (s.quantity == k)
        shares.push_back({{"method", s.method},
                          {"ladder", s.ladder},
                          {"error", number_or_null(s.error)},
                          {"limit", number_or_null(s.limit.value)},
                          {"observed_order", s.limit.extrapolated ? Json(s.limit.order) : Json(nullptr)},
                          {"uncertainty", number_or_null(s.limit.uncertainty)},
                          {"how", s.limit.how}});
    j["quantities"].push_back(
        {{"name", r.study.quantities[k].name},
         {"value", r.study.quantities[k].value},
         {"reference", {{"value", number_or_null(ref.value)}, {"uncertainty", number_or_null(ref.uncertainty)}, {"how", ref.how}}},
         {"errors", ref.relative ? "relative" : "absolute"},
         {"error_shares", shares},
         {"cpu_seconds_at_error", curves}});
  }
  j["findings"] = findings(r);
  j["notes"] = r.notes;
  j["runs"] = Json::array();
  for (const RunResult& run : r.runs) {
    Json values = Json::array();
    for (double v : run.values) values.push_back(number_or_null(v));
    j["runs"].push_back({{"id", run.id},
                         {"label", run.label},
                         {"exit_code", run.code},
                         {"message", run.message},
                         {"cpu_seconds", number_or_null(run.seconds)},
                         {"cpu_seconds_slowest", number_or_null(run.slowest)},
                         {"cpu_seconds_of_processes", number_or_null(run.process)},
                         {"load_average", number_or_null(run.load)},
                         {"newton_iterations", run.newton},
                         {"dofs", run.dofs},
                         {"grade", run.grade},
                         {"values", values}});
  }
  return json_text(j, 1) + "\n";
}

}  // namespace mortise::study
