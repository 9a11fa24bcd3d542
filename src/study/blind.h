#pragma once
// Elements that have no free node deform as pins and bonds say, whatever they are made of: jumps of stresses do not tell how wrong that is.
#include <span>
#include <string>
#include <vector>

#include "model/input.h"
#include "study/error_budget.h"

namespace mortise::study {

class Blind {
 public:
  explicit Blind(const model::ModelInput& input);
  // cauchy_stress of all output cells of a state, six components each (xx yy zz xy yz zx) [Pa].
  void see(std::span<const double> stress);
  bool soft() const { return !bodies_.empty(); }
  // The mesh's part that was found of an error, or why it is not to be had of the states that were seen.
  ErrorPart part(double found) const;

 private:
  struct Body {
    std::string name;
    std::size_t first_cell;
    std::vector<double> volume;  // of tetrahedra [m^3]
    std::vector<bool> held;      // those without a free node
    double nu;
    double all = 0, blind = 0;  // energy of all states, times 2 E, and that of elements without a free node
  };
  std::vector<Body> bodies_;
};

}  // namespace mortise::study
