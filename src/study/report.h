#pragma once
// What a study leaves in its folder and tells on the terminal.
#include <string>

#include "study/results.h"

namespace mortise::study {

std::string points_csv(const Results& results);
std::string study_json(const Results& results);
std::string text_report(const Results& results);  // the tables of the terminal
std::string page_html(const Results& results);    // opens offline: the figure is in it

// The scene with the settings of the knee of the first quantity; empty for benchmarks and where there is none.
std::string recommended_yaml(const Results& results);

// points.csv, study.json, work_precision.svg and .png, study.html, recommended.yaml. Throws Error(Exit::file).
void write_reports(const Results& results, const std::string& folder);

// Sentences that a reader looks for first: how wrong the scene is as it is, what the knee costs, what half its error would.
std::vector<std::string> findings(const Results& results);

// "2.1 %", "3e-7"; of errors that are not relative the number.
std::string error_text(double error, const Reference& reference);
std::string seconds_text(double seconds);

}  // namespace mortise::study
