#pragma once
// What the values of a ladder of settings tend to, and how well that is known.
#include <string>
#include <vector>

namespace mortise::study {

struct Limit {
  double value = 0;
  bool extrapolated = false;  // else the value is that of the finest run
  double order = 0;           // observed; 0 where none was
  double uncertainty = 0;     // of `value`; NaN: not known
  std::string how;            // "extrapolated at an observed order of 1.9", "the finest run: ..."
};

// Sizes of the settings of a ladder, coarse to fine: lengths, times and tolerances as they are, numbers of steps or cells and stiffnesses as their
// inverses. Empty where the settings are no numbers of one unit, or neither fall nor rise all along.
std::vector<double> ladder_sizes(const std::vector<std::string>& settings);

// Why numbers cannot be a ladder from coarse to fine; empty where they can, or where they are no numbers.
std::string not_a_ladder(const std::vector<std::string>& settings);

// A number with a unit of whatever dimension, in SI; NaN if it is none.
double any_number(const std::string& text);

// Richardson's limit of the last three values, q(h) = q + C h^p with the order p observed from
//   (q1 - q2) / (q2 - q3) = (h1^p - h2^p) / (h2^p - h3^p),
// whatever the ratios of the sizes h1 > h2 > h3 are (Roache, Verification and Validation in Computational Science and Engineering, 1998,
// ch. 5). The last value itself where differences change sign, no order between 0.5 and 5 explains them, or no sizes are known.
// Uncertainty: 1.25 |q - q3| from three values; from four or more 1.25 times the change of the limit by the last of them (and no less than a tenth of
// |q - q3|); without a limit 3 |q2 - q3|, and no less than |q1 - q2| where differences change sign or fall faster than at order 5.
Limit limit_of(const std::vector<double>& sizes, const std::vector<double>& values);

}  // namespace mortise::study
