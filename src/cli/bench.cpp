// mortise bench: named benchmarks with known answers.
#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "bench/benchmark.h"
#include "bench/ccd/ccd.h"
#include "cli/bench_hard.h"
#include "cli/bench_result.h"
#include "cli/commands.h"
#include "engine/choose.h"
#include "scene/suggest.h"

namespace mortise::cli {
namespace {

struct BenchOptions {
  std::string name, data, result, device = "cpu";
  std::vector<std::string> sets;
  int threads = 0;
  bool json = false, list = false;
  HardFlags hard;
};

int bench_ccd(const BenchOptions& o) {
  if (o.data.empty()) throw Error(Exit::usage, "bench ccd needs --data DIR, a folder of query files");
  const bench::CcdBench result = bench::ccd_bench(o.data);
  if (o.json) {
    for (const auto& [kind, s] : {std::pair{"point_triangle", &result.point_triangle}, std::pair{"edge_edge", &result.edge_edge}})
      std::cout << json_text(nlohmann::ordered_json{{"case", "ccd"},
                                                    {"kind", kind},
                                                    {"queries", s->queries},
                                                    {"impacts", s->impacts},
                                                    {"false_negatives", s->false_negatives},
                                                    {"false_positives", s->false_positives},
                                                    {"seconds", s->seconds},
                                                    {"microseconds_per_query", s->microseconds_per_query()}})
                << "\n";
  } else {
    std::cout << result.text();
  }
  return static_cast<int>(result.point_triangle.false_negatives + result.edge_edge.false_negatives == 0 ? Exit::done : Exit::solve);
}

// Nodes along the edges of the cubes whose matrices are multiplied: by default from what fits into caches to what does not.
std::vector<Index> bandwidth_edges(const std::vector<std::string>& sets) {
  constexpr Index kMost = 100;  // its matrix takes a gigabyte
  if (sets.empty()) return {20, 34, 54};
  std::vector<Index> out;
  for (const std::string& set : sets) {
    int edge = 0, end = 0;
    if (std::sscanf(set.c_str(), "edge=%d%n", &edge, &end) != 1 || set.c_str()[end] != 0 || edge < 2 || edge > kMost)
      throw Error(Exit::usage, fmt::format("bench bandwidth: '{}' is not edge=N, nodes along the edge of a cube, 2 to {}", set, kMost));
    out.push_back(edge);
  }
  return out;
}

// The matrix product against a plain copy.
int bench_bandwidth(const BenchOptions& o) {
  auto list = nlohmann::ordered_json::array();
  if (!o.json)
    std::cout << fmt::format("{:>8} {:>9} {:>14} {:>14} {:>14} {:>8}\n", "rows", "blocks", "product us", "product GB/s", "copy GB/s", "share");
  for (const Index edge : bandwidth_edges(o.sets)) {
    engine::Bandwidth b;
    const engine::Outcome outcome = engine::chosen().api->bandwidth(edge, b);
    if (outcome.code != 0) throw Error(static_cast<Exit>(outcome.code), outcome.message);
    const double product = b.multiply_bytes / b.multiply_seconds, copy = b.copy_bytes / b.copy_seconds;
    list.push_back({{"case", "bandwidth"},
                    {"rows", b.rows},
                    {"blocks", b.blocks},
                    {"product_seconds", b.multiply_seconds},
                    {"product_bytes_per_second", product},
                    {"copy_bytes_per_second", copy},
                    {"share", product / copy}});
    if (o.json)
      std::cout << json_text(list.back()) << std::endl;
    else
      std::cout << fmt::format("{:>8} {:>9} {:>14.1f} {:>14.2f} {:>14.2f} {:>8.2f}\n", b.rows, b.blocks, b.multiply_seconds * 1e6, product * 1e-9,
                               copy * 1e-9, product / copy)
                << std::flush;
  }
  if (!o.result.empty()) write_result(o.result, o.name, list);
  return static_cast<int>(Exit::done);
}

constexpr const char* kBandwidthHelp = "matrix product y = A x against a copy: bytes per second on the chosen device";

int bench_named(const BenchOptions& o, const bench::Benchmark& benchmark) {
  if (!o.json) std::cout << bench::table_header();
  const auto row = [&](const bench::Row& r) { std::cout << (o.json ? bench::json_line(r) + "\n" : bench::table_line(r)) << std::flush; };
  const auto note = [](const std::string& text) { std::cerr << text << "\n"; };
  const auto rows = bench::run_benchmark(benchmark, o.sets, {row, o.hard.output.empty() ? "out/bench/" + o.name : o.hard.output, note});
  if (!o.result.empty()) {
    auto list = nlohmann::ordered_json::array();
    for (const bench::Row& row : rows) list.push_back(nlohmann::ordered_json::parse(bench::json_line(row)));
    write_result(o.result, o.name, list);
  }
  for (const bench::Row& row : rows)
    if (row.gated() && !row.pass()) return static_cast<int>(Exit::solve);
  return static_cast<int>(Exit::done);
}

constexpr const char* kCcdHelp = "continuous collision detection against queries with exact answers (--data DIR)";

int cmd_bench(const BenchOptions& o) {
  std::vector<std::string> names{"ccd", "bandwidth", "hard", "fuzz"};
  for (const bench::Benchmark& b : bench::benchmarks()) names.push_back(b.name);
  if (o.list) {
    for (const bench::Benchmark& b : bench::benchmarks()) std::cout << fmt::format("{:12} {}\n", b.name, b.help);
    std::cout << fmt::format("{:12} {}\n{:12} {}\n{:12} {}\n{:12} {}\n", "ccd", kCcdHelp, "bandwidth", kBandwidthHelp, "hard", kHardHelp, "fuzz",
                             kFuzzHelp);
    return 0;
  }
  setenv("MORTISE_DEVICE", o.device.c_str(), 1);  // for cases that run in processes of their own
  engine::choose(o.device, o.threads);
  if (o.name == "bandwidth") return bench_bandwidth(o);
  const bool plain = o.name == "ccd" || o.name == "fuzz" || o.name == "hard";
  if (plain && !o.sets.empty()) throw Error(Exit::usage, "bench " + o.name + " has nothing to --set");
  if (o.name == "ccd") return bench_ccd(o);
  if (o.name == "fuzz") return bench_fuzz(o.hard, o.result, o.threads, o.json);
  if (o.name == "hard") return bench_hard(o.hard, o.data, o.result, o.threads, o.json);
  if (const bench::Benchmark* b = bench::find_benchmark(o.name)) return bench_named(o, *b);
  if (o.name.empty()) throw Error(Exit::usage, "name a benchmark; see 'mortise bench --list'");
  throw Error(Exit::usage, "no benchmark '" + o.name + "'\n  " + scene::suggestion(o.name, names));
}

}  // namespace

void add_bench(Command app, Context& context) {
  const Command sub = app.command("bench", "run a benchmark with a known answer");
  auto o = std::make_shared<BenchOptions>();
  sub.option("name", o->name, "which; see --list");
  sub.flag("--list", o->list, "list the benchmarks");
  sub.option("--data", o->data, "folder with the benchmark's data");
  sub.flag("--json", o->json, "one JSON object per row");
  sub.option("--set", o->sets,
             "value of the benchmark's scene (a.b=c) or an option of its own (methods=gmcp_consistent,ipc_classic; size=medium; edge=20)");
  sub.option("--result", o->result, "also write the rows and the machine to this file");
  add_device_options(sub, o->device, o->threads);
  add_hard_flags(sub, o->hard);
  sub.footer(
      "Examples:\n  mortise bench --list\n  mortise bench patch\n  mortise bench hertz --set size=medium --json\n  mortise bench ccd --data queries "
      "--json\n  mortise bench hard --only H11");
  sub.action([o, &context] { context.action = [o] { return cmd_bench(*o); }; });
}

}  // namespace mortise::cli
