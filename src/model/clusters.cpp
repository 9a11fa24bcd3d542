#include "model/clusters.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace mortise::model {
namespace {

// The least number of tetrahedra that the star of a vertex on the surface may have: a cell of a box. Stars of corners and edges
// may be a single one, which would lock as ever.
constexpr std::size_t kLeastOnSurface = 6;
constexpr Index kNone = -1;

// The tetrahedron across face k (opposite corner k) of every tetrahedron, kNone at the surface.
std::vector<std::array<Index, 4>> neighbours(const std::vector<Tet>& tets) {
  struct Side {
    std::array<Index, 3> face;
    Index tet;
    int k;
  };
  std::vector<Side> sides;
  for (std::size_t t = 0; t < tets.size(); ++t)
    for (int k = 0; k < 4; ++k) {
      std::array<Index, 3> face{tets[t].v[(k + 1) % 4], tets[t].v[(k + 2) % 4], tets[t].v[(k + 3) % 4]};
      std::sort(face.begin(), face.end());
      sides.push_back({face, static_cast<Index>(t), k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.face != b.face ? a.face < b.face : a.tet < b.tet; });
  std::vector<std::array<Index, 4>> out(tets.size(), {kNone, kNone, kNone, kNone});
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.face == b.face) out[a.tet][a.k] = b.tet, out[b.tet][b.k] = a.tet;
  }
  return out;
}

}  // namespace

std::vector<Index> star_clusters(const BodyInput& body) {
  std::vector<std::vector<Index>> star(body.nodes.size());
  for (std::size_t t = 0; t < body.tets.size(); ++t)
    for (Index v : body.tets[t].v) star[v].push_back(static_cast<Index>(t));
  std::vector<std::uint8_t> on_surface(body.nodes.size(), 0);
  for (const Triangle& t : body.triangles)
    for (Index v : t.v) on_surface[v] = 1;

  std::vector<Index> cluster(body.tets.size(), kNone);
  std::vector<Index> size;  // tetrahedra of every cluster
  for (const int surface : {0, 1})
    for (std::size_t v = 0; v < star.size(); ++v) {
      if (on_surface[v] != surface || star[v].empty() || (surface && star[v].size() < kLeastOnSurface)) continue;
      if (std::any_of(star[v].begin(), star[v].end(), [&](Index t) { return cluster[t] != kNone; })) continue;
      for (Index t : star[v]) cluster[t] = static_cast<Index>(size.size());
      size.push_back(static_cast<Index>(star[v].size()));
    }

  const std::vector<std::array<Index, 4>> across = neighbours(body.tets);
  std::vector<Index> left;
  for (std::size_t t = 0; t < cluster.size(); ++t)
    if (cluster[t] == kNone) left.push_back(static_cast<Index>(t));
  while (!left.empty()) {
    std::vector<Index> later;
    for (Index t : left) {
      Index smallest = kNone;
      for (Index n : across[t])
        if (n != kNone && cluster[n] != kNone && (smallest == kNone || size[cluster[n]] < size[smallest])) smallest = cluster[n];
      if (smallest == kNone) {
        later.push_back(t);
        continue;
      }
      cluster[t] = smallest, ++size[smallest];
    }
    if (later.size() == left.size()) {  // none has a neighbour in a cluster
      cluster[later.front()] = static_cast<Index>(size.size());
      size.push_back(1);
      later.erase(later.begin());
    }
    left = std::move(later);
  }
  return cluster;
}

void ClusterLists::add(const std::vector<Index>& cluster, const std::vector<Tet>& tets, Index first, const double* volumes, double lame_lambda,
                       Index of_env) {
  const Index base = static_cast<Index>(lambda.size());
  of_tet.resize(first, kNone);
  std::vector<Index> order(cluster.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return cluster[a] < cluster[b]; });
  for (Index c : cluster) of_tet.push_back(base + c);
  for (std::size_t i = 0; i < order.size();) {
    const Index c = cluster[order[i]];
    std::size_t end = i;
    std::vector<Index> nodes;
    double sum = 0;
    for (; end < order.size() && cluster[order[end]] == c; ++end) {
      for (Index v : tets[first + order[end]].v) nodes.push_back(v);
      sum += volumes[order[end]];
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    for (; i < end; ++i) {
      tet.push_back(first + order[i]);
      for (Index v : tets[first + order[i]].v)
        slot.push_back(first_node.back() + static_cast<Index>(std::lower_bound(nodes.begin(), nodes.end(), v) - nodes.begin()));
    }
    node.insert(node.end(), nodes.begin(), nodes.end());
    owner.insert(owner.end(), nodes.size(), base + c);
    first_tet.push_back(static_cast<Index>(tet.size()));
    first_node.push_back(static_cast<Index>(node.size()));
    lambda.push_back(lame_lambda), volume.push_back(sum), env.push_back(of_env);
  }
}

}  // namespace mortise::model
