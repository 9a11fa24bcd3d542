#pragma once
// What the error budget of a run (error_budget.h) says that each knob leaves of quantities: then no neighbours of it need to be run.
#include <string>
#include <vector>

#include "study/accuracy_knobs.h"
#include "study/accuracy_model.h"

namespace mortise::study {

struct KnobErrors {
  std::vector<std::vector<double>> left;  // what is to be added to every quantity because of every knob,
  std::vector<double> rest;               // and because of what none refines
  std::string why_not;                    // knobs are not all estimated; empty where they are
};

// certificate: JSON text of the run's.
KnobErrors knob_errors(const std::string& certificate, const std::vector<Quantity>& quantities, const std::vector<AutoKnob>& knobs);

// Of two runs that budgets were told of.
struct Known {
  std::vector<double> values;  // of the quantities
  std::vector<double> sizes;   // of the knobs
  KnobErrors errors;
};

// The order at which what a knob leaves of a quantity falls from a run to a finer one; 1 where that does not show.
double order_between(const Known& coarse, const Known& fine, std::size_t knob, std::size_t quantity);

// What came of a quantity from the coarse to the fine run, over what was foretold to: above 1 errors are larger than estimates.
double come_over_foretold(const Known& coarse, const Known& fine, std::size_t quantity);

}  // namespace mortise::study
