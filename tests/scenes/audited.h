#pragma once
// Runs a scene and has its energies audited as `mortise run` does.
#include "audit/state_audit.h"
#include "rig.h"

namespace mortise::testing {

// Takes steps; look(report, what is said) after each.
template <class Look>
audit::EnergyAudit::Result audited(Rig& rig, long steps, Look look) {
  audit::EnergyAudit audit(rig.input);
  audit.state({rig.fields(), rig.engine->points()});
  for (long i = 0; i < steps; ++i) {
    const solver::StepReport report = rig.step();
    const Captured said = rig.fields();
    audit.state({said, rig.engine->points()});
    audit.step(report.first_order > 0);
    look(report, said);
  }
  return audit.result();
}

struct Turned {
  audit::EnergyAudit::Result energy;
  double way = 0;
  int first_order = 0;
};

inline Turned turn(const std::string& scene, int steps, const std::vector<std::string>& overrides = {}) {
  Rig rig(scene, overrides);
  const std::vector<double> start = rig.engine->points();
  Turned out;
  out.energy = audited(rig, steps, [&](const solver::StepReport& report, const Captured&) { out.first_order += report.first_order; });
  const audit::MeasuredBody body(rig.input.bodies[0], 0);
  const std::vector<double> end = rig.engine->points();
  out.way = body.mean(end, end)[0] - body.mean(start, start)[0];
  return out;
}

}  // namespace mortise::testing
