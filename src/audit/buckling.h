#pragma once
// Slender soft bodies that should have given way to the side. A bar whose length between its supports is L, and whose cross-section has the radius of
// gyration i about its weaker axis, stays straight up to the compression
//
//     e_cr = 4 pi^2 (i / L)^2      both ends held (Euler; held less firmly it is less),     pi^2 / 4 (i / L)^2      one end free
//
// along its own line, and bears next to nothing more beyond. But a mesh that is too coarse is too stiff to bend, and without anything that pushes to
// the side a body stands on its saddle for ever. So what its line is shorter by at the end of a run, e, is held against that:
//
//     buckling = max(e / e_cr - 1, 0)      by which the force is too large
//
// of the longest part that no pin, bond or contact holds, of the body where it is most. A body that has buckled has e = e_cr, however far. In motion
// it takes about a period of the bar's lowest bending to give way, over which e is a mean.
#include <vector>

#include "base/archive.h"
#include "base/snapshot.h"
#include "model/input.h"

namespace mortise::audit {

class Buckling {
 public:
  explicit Buckling(const model::ModelInput& input);
  void state(const Snapshot& said, const std::vector<double>& points);
  double value() const;  // of the last state; NaN without slender soft bodies
  void checkpoint(Archive& archive);

 private:
  struct Bar {
    std::size_t first;          // point
    std::vector<double> along;  // of every point at rest [m]
    std::vector<Vec3> rest;
    double gyration, speed;  // i [m]; of sound [m/s]
    double beyond = 0;       // e / e_cr - 1
  };
  // The longest part between supports, and whether both of its ends are held.
  struct Span {
    double from, to;
    bool held;
    double length() const { return to - from; }
  };
  static Span free_span(const Bar& bar, const Snapshot& said);
  static double shortened(const Bar& bar, const Span& span, const std::vector<double>& points);

  double step_;  // [s]; NaN in statics
  std::vector<Bar> bars_;
};

}  // namespace mortise::audit
