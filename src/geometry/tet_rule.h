#pragma once
// Rule with 14 points for tetrahedra, all weights positive, exact to degree 5 (Walkington, *Quadrature on simplices of arbitrary
// dimension*, 2000). On the host: the integrals that are taken once.
#include <array>
#include <cstddef>
#include <utility>

namespace mortise::geometry {

struct TetRulePoint {
  double l[4];    // barycentrics
  double weight;  // share of the volume
};

inline std::array<TetRulePoint, 14> tet_rule_5() {
  std::array<TetRulePoint, 14> rule;
  std::size_t n = 0;
  for (const auto& [a, w] : {std::pair{0.31088591926330060980, 0.11268792571801585080}, std::pair{0.092735250310891226402, 0.073493043116361949544}})
    for (int k = 0; k < 4; ++k, ++n)
      for (int i = 0; i < 4; ++i) rule[n].l[i] = i == k ? 1 - 3 * a : a, rule[n].weight = w;
  const double b = 0.045503704125649649492;
  for (int j = 0; j < 4; ++j)
    for (int k = j + 1; k < 4; ++k, ++n)
      for (int i = 0; i < 4; ++i) rule[n].l[i] = i == j || i == k ? 0.5 - b : b, rule[n].weight = 0.042546020777081466438;
  return rule;
}

}  // namespace mortise::geometry
