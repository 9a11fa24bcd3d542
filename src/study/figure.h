#pragma once
#include <string>

#include "study/results.h"

namespace mortise::study {

// Error over CPU seconds, both logarithmic, one panel per quantity: a curve per method or knob, the Pareto front and its knee, hollow points where
// the reference is no better, a band of its uncertainty, failed runs as crosses on the upper edge.
std::string figure_svg(const Results& results);
void write_figure_png(const Results& results, const std::string& path);

}  // namespace mortise::study
