#pragma once
// What a quantity is in the results of a run.
#include <string>
#include <vector>

#include "output/field_reader.h"
#include "study/study.h"

namespace mortise::study {

// NaN where it was never reported. Throws Error(Exit::usage) with what there is where the file knows no such thing.
double measure(const output::FieldReader& file, const Quantity& quantity);

// Of a largest or smallest value over time, or both: what it is away from the farther of the values a frame before and after. 0 of others.
double missed_between(const output::FieldReader& file, const Quantity& quantity);
// The same of what goes on evenly but for where it turns, as load steps do: how much farther it would be where lines through the two values before
// and the two after meet.
double turned_between(const output::FieldReader& file, const Quantity& quantity);

// Of what is measured at one time: the most that two runs of the same frames are apart up to then, over the largest value of the first. 0 of others.
double largest_apart(const output::FieldReader& file, const output::FieldReader& other, const Quantity& quantity);

// Values over time, in the order of time, without those that were not reported.
struct History {
  std::vector<double> time, value;
};
double reduced(const History& history, const Quantity& quantity);

// A field of the points of a body in one frame, as one number. values: of all points of the file, `components` each; areas: what these stand for
// [m^2], a third of the triangles around them where there are none.
double over_body(const output::OutputMesh& mesh, const std::vector<Vec3>& points, const output::FieldValues& values, const Quantity& quantity,
                 const std::vector<double>& areas = {});

// Points of the file whose values, with these weights, are the field at `quantity.point` of the body at rest: those of the cell that holds it, or
// that it is least far outside of. Throws Error(Exit::usage) where it is far from the body.
using PointWeights = std::vector<std::pair<std::int64_t, double>>;
PointWeights weights_at(const output::OutputMesh& mesh, const Quantity& quantity);

}  // namespace mortise::study
