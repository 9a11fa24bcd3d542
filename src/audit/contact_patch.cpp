#include "audit/contact_patch.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "audit/tuning.h"
#include "audit/vector_at.h"

namespace mortise::audit {
namespace {

void unite(std::vector<Index>& ring) {
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
}

// int N_i N_j dA over a triangle of six nodes with straight edges, of its area / 180 (geometry/quadratic.h).
constexpr double kSixNodes[6][6] = {{6, -1, -1, 0, -4, 0},  {-1, 6, -1, 0, 0, -4},  {-1, -1, 6, -4, 0, 0},
                                    {0, 0, -4, 32, 16, 16}, {-4, 0, 0, 16, 32, 16}, {0, -4, 0, 16, 16, 32}};

// Does `area` make up all of the facets that are pressed, counted as contact_area does (effects/contact/nodal_pressure.h)?
bool whole(double area, const Vec3& force, const std::vector<Index>& pressed, const std::vector<Vec3>& normal) {
  double all = 0;
  for (Index t : pressed) all += std::max(-normal[t].dot(force), 0.0) / (6 * std::max(force.norm(), std::numeric_limits<double>::min()));
  return area >= tuning::kWhole * all;
}

}  // namespace

ContactPatch::ContactPatch(const model::ModelInput& input) {
  std::size_t number = 0;
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    const Index first = static_cast<Index>(rest_.size());
    rest_.insert(rest_.end(), in.nodes.begin(), in.nodes.end());
    body_.insert(body_.end(), in.nodes.size(), number++);
    around_.resize(rest_.size());
    if (in.type != model::BodyType::soft) continue;
    for (std::size_t k = 0; k < in.triangles.size(); ++k) {
      const Triangle& t = in.triangles[k];
      for (Index v : t.v) around_[first + v].push_back(static_cast<Index>(facets_.size()));
      facets_.push_back({{{first + t.v[0], first + t.v[1], first + t.v[2]}}, in.faces.empty() ? -1 : static_cast<Index>(faces_.size() + k / 4)});
    }
    for (const geometry::Face& face : in.faces) {
      faces_.emplace_back();
      for (int k = 0; k < 6; ++k) faces_.back()[k] = first + face.v[k];
    }
  }
}

std::vector<ContactPatch::Node> ContactPatch::covered(const Fields& f) const {
  if (f.pressure.size() != rest_.size() || f.force.size() != 3 * rest_.size()) return {};
  const auto now = [&](Index i) -> Vec3 { return f.displacement.size() == f.force.size() ? rest_[i] + at(f.displacement, i) : rest_[i]; };
  std::vector<Vec3> normal;  // of all triangles, times twice their area
  for (const auto& [t, face] : facets_) normal.push_back((now(t.v[1]) - now(t.v[0])).cross(now(t.v[2]) - now(t.v[0])));
  const auto ring_of = [&](std::size_t i, const auto& takes) {
    std::vector<Index> ring;
    for (Index t : around_[i])
      if (takes(t))
        for (Index v : facets_[t].corners.v)
          if (v != static_cast<Index>(i)) ring.push_back(v);
    unite(ring);
    return ring;
  };
  const auto loaded = [&](Index j) { return f.pressure[j] > 0; };
  std::vector<std::uint8_t> covered(rest_.size(), 0);
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    covered[i] = !around_[i].empty() && loaded(static_cast<Index>(i));
    if (covered[i] || around_[i].empty()) continue;
    const std::vector<Index> ring = ring_of(i, [](Index) { return true; });
    covered[i] = 2 * std::count_if(ring.begin(), ring.end(), loaded) > static_cast<std::ptrdiff_t>(ring.size());
  }
  // Where no force is, as on corners of quadratic faces, that of the neighbours tells the side.
  struct Pressed {
    Vec3 force;
    std::vector<Index> facets;
  };
  std::vector<std::optional<Pressed>> known(rest_.size());
  const auto pressed_at = [&](std::size_t i) -> const Pressed& {
    if (known[i]) return *known[i];
    Vec3 force = at(f.force, i);
    if (force.isZero(0) || facets_[around_[i][0]].face >= 0)
      for (Index j : ring_of(i, [](Index) { return true; })) force += at(f.force, j);
    return known[i].emplace(Pressed{force, sheet(i, force, normal)});
  };
  const auto is_whole = [&](Index i) { return f.area.empty() || whole(f.area[i], pressed_at(i).force, pressed_at(i).facets, normal); };
  std::vector<Node> out;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (!covered[i]) continue;
    const std::vector<Index>& pressed = pressed_at(i).facets;
    if (pressed.empty()) continue;
    Node node{i, ring_of(i, [&](Index t) { return std::find(pressed.begin(), pressed.end(), t) != pressed.end(); }), Vec3::Zero(), 0, false, {}};
    for (Index t : pressed) node.normal += normal[t] / 6, node.area += normal[t].norm() / 6;
    node.inside = std::all_of(node.ring.begin(), node.ring.end(), [&](Index j) { return covered[j] != 0; });
    if (node.inside) load(i, pressed, normal, node.load);
    if (!std::all_of(node.load.begin(), node.load.end(), [&](const auto& term) { return covered[term.first] != 0 && is_whole(term.first); }))
      node.load.clear();
    out.push_back(std::move(node));
  }
  return out;
}

std::vector<ContactPatch::Node> ContactPatch::interior(const Fields& fields) const {
  std::vector<Node> out = covered(fields);
  std::erase_if(out, [](const Node& node) { return !node.inside; });
  return out;
}

std::vector<Index> ContactPatch::sheet(std::size_t i, const Vec3& force, const std::vector<Vec3>& normal) const {
  const auto cosine = [](const Vec3& a, const Vec3& b) { return a.dot(b) / std::max(a.norm() * b.norm(), std::numeric_limits<double>::min()); };
  const auto share_an_edge = [&](Index s, Index t) {
    const auto &a = facets_[s].corners.v, &b = facets_[t].corners.v;
    return std::count_if(std::begin(a), std::end(a), [&](Index v) { return std::find(std::begin(b), std::end(b), v) != std::end(b); }) == 2;
  };
  const Index first = *std::max_element(around_[i].begin(), around_[i].end(),
                                        [&](Index s, Index t) { return cosine(normal[s], -force) < cosine(normal[t], -force); });
  if (cosine(normal[first], -force) < tuning::kFacing) return {};
  std::vector<Index> out{first};
  for (std::size_t k = 0; k < out.size(); ++k)
    for (Index t : around_[i])
      if (std::find(out.begin(), out.end(), t) == out.end() && share_an_edge(out[k], t) && cosine(normal[out[k]], normal[t]) > tuning::kSmooth)
        out.push_back(t);
  return out;
}

void ContactPatch::load(std::size_t i, const std::vector<Index>& pressed, const std::vector<Vec3>& normal,
                        std::vector<std::pair<Index, double>>& out) const {
  std::vector<Index> faces;
  double area = 0;
  for (Index t : pressed) {
    if (facets_[t].face < 0)
      area += normal[t].norm() / 6;  // a third: p_i A_i up to second order in the size of the mesh
    else
      faces.push_back(facets_[t].face);
  }
  if (area > 0) out.emplace_back(static_cast<Index>(i), area);
  unite(faces);
  for (Index face : faces) {
    const std::array<Index, 6>& v = faces_[face];
    const auto here = std::find(v.begin(), v.end(), static_cast<Index>(i)) - v.begin();
    double whole = 0;
    for (Index t : around_[v[3]])
      if (facets_[t].face == face) whole += normal[t].norm() / 2;
    // Three of the four quarters are around the middle of an edge; the fourth lies at the corner beyond.
    for (Index t : around_[v[2]])
      if (facets_[t].face == face) whole += normal[t].norm() / 2;
    for (int k = 0; k < 6; ++k) out.emplace_back(v[k], whole / 180 * kSixNodes[here][k]);
  }
}

long ContactPatch::loaded(std::span<const double> pressure) const {
  long n = 0;
  for (std::size_t i = 0; i < std::min(rest_.size(), pressure.size()); ++i) n += !around_[i].empty() && pressure[i] > 0;
  return n;
}

}  // namespace mortise::audit
