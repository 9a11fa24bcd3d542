#include "solver/newton_trace.h"

#include <algorithm>

namespace mortise::solver {

void NewtonTrace::begin(const effects::StepInfo& info, device::View<const Vec3> q, const Residual& r, Index iteration, const Linearised& at,
                        const EnvMask& whose, const StepReports& report) {
  if (!system_.options.trace) return;
  Energies energies;
  device::Fetch fetch;
  system_.potential.energies(q, at, energies, fetch);
  fetch.now("trace");
  for (Index e = 0; e < static_cast<Index>(whose.size()); ++e) {
    if (!whose[e]) continue;
    Iterate now;
    now.time = info.t1_of(e), now.dt = info.dt, now.round = report[e].lag, now.iteration = iteration, now.env = e;
    now.residual = system_.convergence.largest_force(r, e), now.tolerance = report[e].tolerance;
    for (const std::vector<double>& part : energies) now.energy += part[e];
    now.where = name_block(system_.model, worst_block(system_.model, at.gradient, e));
    report[e].trace.push_back(now);
  }
}

void NewtonTrace::end(const EnvTable& envs, const EnvMask& whose, const std::vector<Index>& products, const StepReports& report) {
  if (!system_.options.trace) return;
  for (Index e = 0; e < envs.size(); ++e) {
    if (!whose[e]) continue;
    const auto row = std::find_if(report[e].trace.rbegin(), report[e].trace.rend(), [e](const Iterate& i) { return i.env == e; });
    row->step = envs[e].step, row->alpha = envs[e].alpha, row->products = products.empty() ? 0 : products[e], row->concave = curvature_.concavity(e);
  }
}

}  // namespace mortise::solver
