#pragma once
// The list of benchmarks. A new one is src/bench/NAME/NAME.cpp, one line in benchmark.cpp and the folder benchmarks/NAME.
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/harness.h"

namespace mortise::bench {

// Where results go.
struct BenchOutput {
  std::function<void(const Row&)> row;
  std::string folder;                            // for figures and pictures; empty: none
  std::function<void(const std::string&)> note;  // what was written there or could not be
};

// What a benchmark works with.
class Bench {
 public:
  Bench(std::string scene, const std::vector<std::string>& sets, BenchOutput output);
  // The benchmark's scene with the user's --set of scene values (keys with a dot) applied.
  const SceneText& scene() const { return scene_; }
  // --set of the benchmark's own options (keys without a dot), e.g. size=medium.
  std::string option(const std::string& key, const std::string& fallback) const;
  // The same where they are numbers above 0, and where they count something. Throw Error(Exit::usage) for others.
  double number(const std::string& key, double fallback) const;
  int count(const std::string& key, int fallback) const;
  int order(int fallback) const;  // of elements: 1 or 2
  // The methods to compare: all of them, or those of --set methods=a,b.
  std::vector<Method> methods() const;
  void emit(const Row& row) const { output_.row(row); }
  // Gives `write` the path of a file in the folder for figures and pictures. Without a folder there are none, and where `write` fails for
  // want of a renderer the run goes on.
  void draw(const std::string& file, const std::function<void(const std::string& path)>& write) const;

 private:
  SceneText scene_;
  std::vector<std::pair<std::string, std::string>> options_;
  BenchOutput output_;
};

struct Benchmark {
  const char* name;
  const char* help;
  std::vector<std::string> options;  // its own --set keys beside methods
  void (*run)(const Bench&);
};
std::span<const Benchmark> benchmarks();
const Benchmark* find_benchmark(const std::string& name);
// benchmarks/NAME/scene.yaml, as it was when the program was built.
std::string benchmark_scene(const std::string& name);
// Runs it; rows come as they are measured. Throws Error(Exit::usage) for options it does not have.
std::vector<Row> run_benchmark(const Benchmark& benchmark, const std::vector<std::string>& sets, const BenchOutput& output);

}  // namespace mortise::bench
