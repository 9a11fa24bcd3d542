#pragma once
// Accuracy against time: runs a scene or a benchmark with varied settings and compares quantities of interest.
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace mortise::study {

// "key=v1,v2,...": the first one varied is the ladder along a curve, every combination of the others is a curve of its own.
struct Vary {
  std::string key;
  std::vector<std::string> values;
};
Vary parse_vary(const std::string& text);  // commas inside brackets belong to a value; throws Error(Exit::usage)

// One quantity of one run.
struct Point {
  std::vector<std::pair<std::string, std::string>> settings;  // in the order of the varied keys
  std::string method;                                         // of a benchmark; empty for scenes
  std::string quantity;
  double value = 0, error = 0;  // |value/reference - 1|, or |value| where the reference is 0
  double seconds = 0;           // of the steps
  long newton_iterations = 0, dofs = 0;
  bool failed = false;     // did not converge
  bool reference = false;  // the others are compared with it
  bool best = false;       // on the Pareto front: nothing faster is as accurate
  std::string curve() const;
};

struct Study {
  std::string scene;                   // path, or the name of a benchmark
  std::vector<std::string> overrides;  // --set of all runs
  std::vector<Vary> vary;
  std::vector<std::string> quantities;  // "group/name" of scalars at the last step; `quantity` of a benchmark's rows
  std::vector<double> references;       // one per quantity of a scene; none: limit.h
  int repeats = 1;                      // runs of every setting; the fastest counts
};

// Runs everything, on the CPU. Scene settings that the scene does not have, and quantities that nothing reports, are Error(Exit::usage |
// Exit::scene). `note` is told what each quantity of a scene was compared with.
std::vector<Point> run_study(
    const Study& study, const std::function<void(const Point&)>& done,
    const std::function<void(const std::string&)>& note = [](const std::string&) {});

// Marks the fronts, quantity by quantity: sorted by time, those with less error than all before.
void mark_best(std::vector<Point>& points);

std::string points_csv(const std::vector<Point>& points);
// Error over seconds of one quantity, both logarithmic: one line per curve, the front dashed, the reference left out, failed runs as crosses.
std::string figure_svg(const std::vector<Point>& points, const std::string& quantity, const std::string& title);

}  // namespace mortise::study
