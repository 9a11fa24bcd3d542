#include "geometry/cut_edges.h"

#include <algorithm>
#include <map>
#include <queue>
#include <utility>

namespace mortise::geometry {
namespace {

using Ends = std::pair<Index, Index>;  // the smaller first

Ends ends_of(Index a, Index b) { return std::minmax(a, b); }

class Cutter {
 public:
  Cutter(TriMesh& mesh, double longest, const std::function<bool(const Vec3 (&corner)[3])>& wanted)
      : mesh_(mesh), longest_(longest), wanted_(wanted) {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) join(t);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) look(t);
  }
  void cut() {
    while (!queue_.empty()) {
      const Ends e = queue_.top().second;
      queue_.pop();
      if (const auto found = sides_.find(e); found != sides_.end()) cut(e, std::vector<std::size_t>(found->second));
    }
  }

 private:
  void join(std::size_t t) {
    const Index* v = mesh_.triangles[t].v;
    for (int k = 0; k < 3; ++k) sides_[ends_of(v[k], v[(k + 1) % 3])].push_back(t);
  }
  void part(std::size_t t) {
    const Index* v = mesh_.triangles[t].v;
    for (int k = 0; k < 3; ++k) {
      const auto at = sides_.find(ends_of(v[k], v[(k + 1) % 3]));
      std::erase(at->second, t);
      if (at->second.empty()) sides_.erase(at);
    }
  }
  void look(std::size_t t) {
    const Index* v = mesh_.triangles[t].v;
    const Vec3 corner[3] = {mesh_.points[v[0]], mesh_.points[v[1]], mesh_.points[v[2]]};
    if (!wanted_(corner)) return;
    for (int k = 0; k < 3; ++k)
      if (const double length = (corner[(k + 1) % 3] - corner[k]).norm(); length > longest_) queue_.push({length, ends_of(v[k], v[(k + 1) % 3])});
  }
  void cut(const Ends& e, const std::vector<std::size_t>& around) {
    const Index middle = static_cast<Index>(mesh_.points.size());
    mesh_.points.push_back((mesh_.points[e.first] + mesh_.points[e.second]) / 2);
    for (const std::size_t t : around) {
      part(t);
      Triangle one = mesh_.triangles[t], other = one;
      std::replace(std::begin(one.v), std::end(one.v), e.second, middle);
      std::replace(std::begin(other.v), std::end(other.v), e.first, middle);
      const std::size_t last = mesh_.triangles.size();
      mesh_.triangles[t] = one, mesh_.triangles.push_back(other);
      join(t), join(last);
      look(t), look(last);
    }
  }

  TriMesh& mesh_;
  double longest_;
  const std::function<bool(const Vec3 (&corner)[3])>& wanted_;
  std::map<Ends, std::vector<std::size_t>> sides_;      // triangles at every edge
  std::priority_queue<std::pair<double, Ends>> queue_;  // by length [m]
};

}  // namespace

void cut_edges(TriMesh& mesh, double longest, const std::function<bool(const Vec3 (&corner)[3])>& wanted) { Cutter(mesh, longest, wanted).cut(); }

}  // namespace mortise::geometry
