#pragma once
// What a quantity is in the results of a run.
#include <string>
#include <vector>

#include "output/field_reader.h"
#include "study/study.h"

namespace mortise::study {

// NaN where it was never reported. Throws Error(Exit::usage) with what there is where the file knows no such thing.
double measure(const output::FieldReader& file, const Quantity& quantity);

// Values over time, in the order of time, without those that were not reported.
struct History {
  std::vector<double> time, value;
};
double reduced(const History& history, const Quantity& quantity);

// A field of the points of a body in one frame, as one number. values: of all points of the file, `components` each.
double over_body(const output::OutputMesh& mesh, const std::vector<Vec3>& points, const output::FieldValues& values, const Quantity& quantity);

}  // namespace mortise::study
