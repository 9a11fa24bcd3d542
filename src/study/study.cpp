#include "study/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "bench/benchmark.h"
#include "study/scene_runs.h"

namespace mortise::study {
namespace {

std::vector<std::string> as_overrides(const Settings& settings) {
  std::vector<std::string> out;
  for (const auto& [key, value] : settings) out.push_back(key + "=" + value);
  return out;
}

// Curve by curve, along the ladder.
std::vector<Settings> combinations(const std::vector<Vary>& vary) {
  std::vector<Settings> all{{}};
  for (std::size_t k = vary.size(); k-- > 0;) {
    // The first key changes fastest, so it is put in front last.
    std::vector<Settings> next;
    for (const auto& rest : all)
      for (const std::string& value : vary[k].values) {
        auto with = rest;
        with.insert(with.begin(), {vary[k].key, value});
        next.push_back(std::move(with));
      }
    all = std::move(next);
  }
  return all;
}

void run_benchmarks(const Study& study, const bench::Benchmark& benchmark, std::vector<Point>& points,
                    const std::function<void(const Point&)>& done) {
  for (const auto& settings : combinations(study.vary)) {
    std::vector<std::string> sets = study.overrides;
    for (std::string& s : as_overrides(settings)) sets.push_back(std::move(s));
    const std::size_t before = points.size();
    bench::run_benchmark(benchmark, sets,
                         {[&](const bench::Row& row) {
                            for (const std::string& q : study.quantities) {
                              if (row.quantity != q && row.name + ": " + row.quantity != q) continue;
                              points.push_back({settings, row.method, q, row.value, row.error, row.seconds, row.newton_iterations, row.dofs,
                                                row.failed, false, false});
                            }
                          },
                          {},
                          {}});
    for (int i = 1; i < study.repeats; ++i) {  // the rows come in the same order
      std::size_t at = before;
      bench::run_benchmark(benchmark, sets,
                           {[&](const bench::Row& row) {
                              for (const std::string& q : study.quantities)
                                if (row.quantity == q || row.name + ": " + row.quantity == q)
                                  points[at].seconds = std::min(points[at].seconds, row.seconds), ++at;
                            },
                            {},
                            {}});
    }
    for (std::size_t i = before; i < points.size(); ++i) done(points[i]);
    if (points.size() == before)
      throw Error(Exit::usage, "--qoi: benchmark '" + study.scene + "' has no such quantity (a row's quantity, or 'case: quantity')");
  }
}

}  // namespace

std::string Point::curve() const {
  std::string name = method;
  for (std::size_t k = 1; k < settings.size(); ++k) name += (name.empty() ? "" : ", ") + settings[k].first + "=" + settings[k].second;
  return name;
}

Vary parse_vary(const std::string& text) {
  const std::size_t eq = text.find('=');
  if (eq == std::string::npos || eq == 0 || eq + 1 == text.size()) throw Error(Exit::usage, "--vary " + text + ": write key=value1,value2,...");
  Vary out{text.substr(0, eq), {""}};
  int depth = 0;
  for (char c : text.substr(eq + 1)) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (c == ',' && depth == 0)
      out.values.emplace_back();
    else
      out.values.back() += c;
  }
  for (const std::string& v : out.values)
    if (v.empty()) throw Error(Exit::usage, "--vary " + text + ": a value is empty");
  return out;
}

std::vector<Point> run_study(const Study& study, const std::function<void(const Point&)>& done, const std::function<void(const std::string&)>& note) {
  if (study.vary.empty()) throw Error(Exit::usage, "nothing is varied: give --vary key=value1,value2,...");
  if (study.repeats < 1) throw Error(Exit::usage, "--repeat counts from 1");
  if (study.quantities.empty()) throw Error(Exit::usage, "no quantity to compare: give --qoi group/name");
  if (!study.references.empty() && study.references.size() != study.quantities.size()) throw Error(Exit::usage, "give one --reference per --qoi");
  std::vector<Point> points;
  if (const bench::Benchmark* benchmark = bench::find_benchmark(study.scene)) {
    if (!study.references.empty()) throw Error(Exit::usage, "a benchmark has its own references");
    run_benchmarks(study, *benchmark, points, done);
  } else {
    std::vector<std::string> references;
    run_scenes(study, combinations(study.vary), points, references);
    for (const Point& p : points) done(p);
    for (const std::string& r : references) note(r);
  }
  mark_best(points);
  return points;
}

void mark_best(std::vector<Point>& points) {
  std::vector<Point*> order;
  for (Point& p : points) {
    p.best = false;
    if (!p.failed && !p.reference && std::isfinite(p.error)) order.push_back(&p);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const Point* a, const Point* b) { return a->quantity != b->quantity ? a->quantity < b->quantity : a->seconds < b->seconds; });
  const Point* last = nullptr;
  for (Point* p : order) {
    if (last && last->quantity == p->quantity && !(p->error < last->error)) continue;
    p->best = true;
    last = p;
  }
}

std::string points_csv(const std::vector<Point>& points) {
  const auto quoted = [](const std::string& s) {
    std::string out = "\"";
    for (char c : s) out += c == '"' ? "\"\"" : std::string(1, c);
    return out + "\"";
  };
  std::string csv;
  if (!points.empty())
    for (const auto& [key, value] : points.front().settings) csv += quoted(key) + ",";
  csv += "method,quantity,value,error,seconds,newton_iterations,dofs,status,pareto\n";
  for (const Point& p : points) {
    for (const auto& [key, value] : p.settings) csv += quoted(value) + ",";
    csv += fmt::format("{},{},{:.17g},{:.17g},{:.6g},{},{},{},{}\n", quoted(p.method), quoted(p.quantity), p.value, p.error, p.seconds,
                       p.newton_iterations, p.dofs, p.failed ? "failed" : (p.reference ? "reference" : "done"), p.best ? 1 : 0);
  }
  return csv;
}

}  // namespace mortise::study
