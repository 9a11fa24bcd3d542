#include "judge/clusters.h"

#include <algorithm>
#include <map>
#include <set>

namespace judge {

// Stars of vertices, those inside first, each in the order of their numbers, where no tetrahedron of the star has a group yet; a vertex of the
// surface needs a star of at least six. Then, round by round, what touches a group across faces joins the smallest.
std::vector<long> volume_groups(const Body& body) {
  std::map<long, std::vector<std::size_t>> star;
  std::map<std::set<long>, std::vector<std::size_t>> face;
  for (std::size_t t = 0; t < body.tets.size(); ++t)
    for (int k = 0; k < 4; ++k) {
      star[body.tets[t][k]].push_back(t);
      std::set<long> others(body.tets[t].begin(), body.tets[t].end());
      others.erase(body.tets[t][k]);
      face[others].push_back(t);
    }
  std::set<long> surface;
  for (const auto& t : body.triangles) surface.insert(t.begin(), t.end());

  std::vector<long> group(body.tets.size(), -1);
  std::vector<long> count;
  const auto open = [&](const std::vector<std::size_t>& tets) {
    for (std::size_t t : tets) group[t] = static_cast<long>(count.size());
    count.push_back(static_cast<long>(tets.size()));
  };
  for (bool outside : {false, true})
    for (const auto& [v, tets] : star)
      if (surface.count(v) == (outside ? 1u : 0u) && (!outside || tets.size() >= 6) &&
          std::all_of(tets.begin(), tets.end(), [&](std::size_t t) { return group[t] < 0; }))
        open(tets);

  const auto join = [&](std::size_t t) {
    long best = -1;
    for (int k = 0; k < 4; ++k) {
      std::set<long> others(body.tets[t].begin(), body.tets[t].end());
      others.erase(body.tets[t][k]);
      for (std::size_t n : face[others])
        if (n != t && group[n] >= 0 && (best < 0 || count[group[n]] < count[best])) best = group[n];
    }
    if (best >= 0) group[t] = best, ++count[best];
    return best >= 0;
  };
  for (;;) {
    bool joined = false;
    std::size_t first_alone = body.tets.size();
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
      if (group[t] >= 0) continue;
      if (join(t))
        joined = true;
      else
        first_alone = std::min(first_alone, t);
    }
    if (first_alone == body.tets.size()) return group;
    if (!joined) open({first_alone});
  }
}

}  // namespace judge
