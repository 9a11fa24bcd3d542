// B26: a stack of equal blocks under gravity. Interface k carries the weight of what stands on it; its mean gap follows from the pressure.
#include <fmt/format.h>

#include "bench/all.h"
#include "bench/reference.h"

namespace mortise::bench {

void tower(const Bench& b) {
  constexpr int kBlocks = 5;
  constexpr double kSide = 1, kHeight = 0.5;
  const double rho = b.scene().number("materials.rubber.density"), g = -b.scene().number("effects.gravity.acceleration.2");
  const double d_hat = b.scene().number("effects.mortar_contact.d_hat"), kappa = b.scene().number("effects.mortar_contact.stiffness");
  const double weight = rho * g * kSide * kSide * kHeight;
  for (const Method& m : b.methods()) {
    SceneText scene = b.scene();
    scene.use(m, kSide * kSide / 12);
    const Solved s = solve(scene);
    const auto gate = [&](double v) { return m.gated ? v : NAN; };
    const auto rows = [&](const char* what) {
      const auto it = s.fields.row.find(m.effect + "/" + what);
      return it == s.fields.row.end() ? Snapshot::Values{} : it->second;
    };
    const Snapshot::Values gap = rows("gap"), area = rows("area"), bodies = rows("bodies");
    double above = 0;  // force of contact on all blocks above the interface
    for (int k = kBlocks - 1; k >= 0; --k) {
      const std::string name = fmt::format("interface {}", k);
      above += s.fields.at(fmt::format("{}/force_block{}_z", m.effect, k));
      const double wanted = weight * (kBlocks - k);
      b.emit(s.row(name, m, "force", above, wanted, std::abs(above / wanted - 1), gate(1e-6)));
      // Samples of the interface: bodies k-1 and k; the floor is numbered behind the bodies. Classic samples have no area.
      double sum = 0, total = 0;
      for (std::size_t i = 0; i < gap.size(); ++i) {
        const double lower = std::min(bodies[2 * i], bodies[2 * i + 1]), upper = std::max(bodies[2 * i], bodies[2 * i + 1]);
        if (k > 0 ? lower != k - 1 || upper != k : lower != 0 || upper < kBlocks) continue;
        const double fraction = area[i] > 0 ? area[i] : 1;
        sum += fraction * gap[i], total += fraction;
      }
      const double gap_wanted = d_hat * barrier_gap(wanted / (kappa * kSide * kSide)), mean = sum / total;
      b.emit(s.row(name, m, "mean gap", mean, gap_wanted, std::abs(mean / gap_wanted - 1), gate(1e-3)));
    }
  }
}

}  // namespace mortise::bench
