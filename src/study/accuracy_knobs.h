#pragma once
// What can be refined of a scene without being told.
#include <string>
#include <vector>

#include "base/params.h"
#include "model/input.h"
#include "study/study.h"

namespace mortise::study {

struct AutoKnob {
  std::string name;
  double ratio = 0.5, dearer = 1;  // as in Climb
  bool mesh = false;               // its size is that of the mesh that came out, not the one asked for
  bool layer = false;              // of contact; beside a mesh that came out as it could, this has the size that was asked for
  struct Path {
    std::string path;
    double base;       // at level 0, SI
    bool set = false;  // at level 0 too: the scene has it otherwise
  };
  std::vector<Path> paths;
  long steps = 0;  // of the scene, where their number is what is refined
  double end = 0;  // and the time at which all runs end, whatever steps they take there; 0: of load steps [s]
  Settings settings(int level) const;
  double size(int level) const;        // over that at level 0; that of steps goes by their whole number
  std::string label(int level) const;  // "mesh / 1.4"
};

// Edge lengths of all bodies together; the contact layer where the scene gives its thickness (what is left out follows the mesh); the time step, or
// load steps where friction remembers them or numbers are of more than the end. Of contact pressures layers whose stiffness is left to the program
// are no thinner than tuning::kPressureLayer of the finest soft mesh: on thinner ones pressures scatter more.
std::vector<AutoKnob> auto_knobs(const Params& scene, const std::vector<Quantity>& quantities);
// Mesh and layer as one, in proportion: ladders tell of both together with coarser runs alone, which are cheap.
std::vector<AutoKnob> joined(std::vector<AutoKnob> knobs);

}  // namespace mortise::study
