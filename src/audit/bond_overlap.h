#pragma once
// Soft bodies that reach into the stiff ones they are bonded to. A bond holds nodes: elements that lie across the surface of the stiff body strain up
// to the last row of them inside, though what is inside should be as stiff as what is around it. Of every such body, with W the density of its
// strain energy and U all of it (strain_energy.h),
//
//     overlap = I / (U - I),     I = int over what lies inside of elements with a free node of W dV
//
// is how much too far given forces bring it, and at least by how much too little force given travels take. At the state in which U is largest; of
// the body where it is most. None where the surface of the stiff body goes along faces of elements.
#include <vector>

#include "audit/strain_energy.h"
#include "base/archive.h"
#include "model/input.h"

namespace mortise::audit {

class BondOverlap {
 public:
  explicit BondOverlap(const model::ModelInput& input);
  void state(const std::vector<double>& points);
  double value() const;  // NaN where nothing reaches into what it is bonded to
  void checkpoint(Archive& archive);

 private:
  struct Body {
    StrainEnergy all, inside;
    double most = 0, inside_then = 0;  // [J]
  };
  std::vector<Body> bodies_;
};

}  // namespace mortise::audit
