// mortise bench: named benchmarks with known answers.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "scene/suggest.h"
#include "study/ccd_bench.h"

namespace mortise::cli {
namespace {

struct Options {
  std::string name, data;
  bool json = false, list = false;
};

int bench_ccd(const Options& o) {
  if (o.data.empty()) throw Error(Exit::usage, "bench ccd needs --data DIR, a folder of query files");
  const study::CcdBench result = study::ccd_bench(o.data);
  if (o.json) {
    for (const auto& [kind, s] : {std::pair{"point_triangle", &result.point_triangle}, std::pair{"edge_edge", &result.edge_edge}})
      std::cout << nlohmann::ordered_json{{"case", "ccd"}, {"kind", kind}, {"queries", s->queries}, {"impacts", s->impacts}, {"false_negatives", s->false_negatives},
                                          {"false_positives", s->false_positives}, {"seconds", s->seconds}, {"microseconds_per_query", s->microseconds_per_query()}}
                       .dump()
                << "\n";
  } else {
    std::cout << result.text();
  }
  return static_cast<int>(result.point_triangle.false_negatives + result.edge_edge.false_negatives == 0 ? Exit::done : Exit::solve);
}

struct Benchmark {
  const char* name;
  const char* help;
  int (*run)(const Options&);
};
constexpr Benchmark kBenchmarks[] = {{"ccd", "continuous collision detection against queries with exact answers (--data DIR)", bench_ccd}};

int cmd_bench(const Options& o) {
  if (o.list) {
    for (const Benchmark& b : kBenchmarks) std::cout << fmt::format("{:12} {}\n", b.name, b.help);
    return 0;
  }
  std::vector<std::string> names;
  for (const Benchmark& b : kBenchmarks) {
    if (o.name == b.name) return b.run(o);
    names.push_back(b.name);
  }
  if (o.name.empty()) throw Error(Exit::usage, "name a benchmark; see 'mortise bench --list'");
  throw Error(Exit::usage, "no benchmark '" + o.name + "'\n  " + scene::suggestion(o.name, names));
}

}  // namespace

void add_bench(CLI::App& app, Context& context) {
  CLI::App* sub = app.add_subcommand("bench", "run a benchmark with a known answer");
  auto o = std::make_shared<Options>();
  sub->add_option("name", o->name, "which; see --list");
  sub->add_flag("--list", o->list, "list the benchmarks");
  sub->add_option("--data", o->data, "folder with the benchmark's data");
  sub->add_flag("--json", o->json, "one JSON object per case");
  sub->footer("Examples:\n  mortise bench --list\n  mortise bench ccd --data queries --json");
  sub->callback([o, &context] { context.action = [o] { return cmd_bench(*o); }; });
}

}  // namespace mortise::cli
