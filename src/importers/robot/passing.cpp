#include "importers/robot/passing.h"

#include "geometry/topology.h"
#include "importers/robot/solid.h"
#include "importers/robot/tuning.h"

namespace mortise::importers {

std::vector<PassingPair> passing_pairs(const Machine& m, int apart) {
  const std::size_t bodies = m.bodies.size(), n = bodies + m.pads.size();
  std::vector<std::vector<std::size_t>> beside(n);
  const auto join = [&](std::size_t a, std::size_t b) { beside[a].push_back(b), beside[b].push_back(a); };
  for (const Axis& a : m.axes)
    if (a.to >= 0) join(a.body, static_cast<std::size_t>(a.to));
  for (const ClosingJoint& l : m.loops)
    if (l.to >= 0) join(l.body, static_cast<std::size_t>(l.to));
  for (std::size_t p = 0; p < m.pads.size(); ++p) join(bodies + p, m.pads[p].body);
  const auto shapes = [&](std::size_t i) { return i < bodies ? m.bodies[i].shapes : std::vector<Shape>{m.pads[i - bodies].shape}; };
  std::vector<geometry::TriMesh> surfaces(n);
  for (std::size_t i = 0; i < n; ++i)
    for (const Shape& s : shapes(i)) geometry::append(surface(s, i < bodies ? m.bodies[i].at * s.at : s.at), surfaces[i]);
  const auto said = [&](std::size_t a, std::size_t b) {
    for (const auto& [c, d] : m.apart)
      if ((a == c && b == d) || (a == d && b == c)) return true;
    for (const Shape& s : shapes(a))
      for (const Shape& t : shapes(b))
        if (s.touches(t)) return false;
    return true;
  };
  std::vector<PassingPair> out;
  for (std::size_t a = 0; a < n; ++a) {
    std::vector<int> hops(n, -1);
    hops[a] = 0;
    std::vector<std::size_t> todo{a};
    for (std::size_t k = 0; k < todo.size(); ++k)
      for (std::size_t b : beside[todo[k]])
        if (hops[b] < 0) hops[b] = hops[todo[k]] + 1, todo.push_back(b);
    for (std::size_t b = a + 1; b < n; ++b) {
      if (hops[b] == 1) continue;  // a joint or bond says so already
      if (hops[b] > 1 && hops[b] <= apart)
        out.push_back({a, b, PassingPair::Why::near});
      else if (said(a, b))
        out.push_back({a, b, PassingPair::Why::said});
      else if (meet(surfaces[a], surfaces[b], kOverlap))
        out.push_back({a, b, PassingPair::Why::overlap});
    }
  }
  return out;
}

}  // namespace mortise::importers
