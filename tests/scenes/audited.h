#pragma once
// Runs a scene and has its energies audited as `mortise run` does.
#include "audit/state_audit.h"
#include "rig.h"

namespace mortise::testing {

struct Turned {
  audit::EnergyAudit::Result energy;
  double way = 0;
  int first_order = 0;
};

inline Turned turn(const std::string& scene, int steps, const std::vector<std::string>& overrides = {}) {
  Rig rig(scene, overrides);
  audit::EnergyAudit audit(rig.input);
  const std::vector<double> start = rig.engine->points();
  audit.state({rig.fields(), start});
  Turned out;
  for (int i = 0; i < steps; ++i) {
    const solver::StepReport report = rig.step();
    const std::vector<double> points = rig.engine->points();
    audit.state({rig.fields(), points});
    audit.step(report.first_order > 0);
    out.first_order += report.first_order;
  }
  out.energy = audit.result();
  const audit::MeasuredBody body(rig.input.bodies[0], 0);
  const std::vector<double> end = rig.engine->points();
  out.way = body.mean(end, end)[0] - body.mean(start, start)[0];
  return out;
}

}  // namespace mortise::testing
