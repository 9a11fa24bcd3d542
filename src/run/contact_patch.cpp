#include "run/contact_patch.h"

#include <algorithm>

namespace mortise::run {
namespace {

constexpr double kFacing = 0.7;  // cosine of 45 degrees

Vec3 at(std::span<const double> v, std::size_t i) { return {v[3 * i], v[3 * i + 1], v[3 * i + 2]}; }

void unite(std::vector<Index>& ring) {
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
}

}  // namespace

ContactPatch::ContactPatch(const model::ModelInput& input) {
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    const Index first = static_cast<Index>(rest_.size());
    rest_.insert(rest_.end(), in.nodes.begin(), in.nodes.end());
    around_.resize(rest_.size());
    linear_.resize(rest_.size(), in.midsides.empty());
    if (in.type != model::BodyType::soft) continue;
    for (const Triangle& t : in.triangles) {
      for (Index v : t.v) around_[first + v].push_back(static_cast<Index>(triangles_.size()));
      triangles_.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
    }
  }
}

std::vector<ContactPatch::Node> ContactPatch::interior(const Fields& f) const {
  if (f.pressure.size() != rest_.size() || f.force.size() != 3 * rest_.size()) return {};
  const auto now = [&](Index i) -> Vec3 { return f.displacement.size() == f.force.size() ? rest_[i] + at(f.displacement, i) : rest_[i]; };
  std::vector<Vec3> normal;  // of all triangles, times twice their area
  for (const Triangle& t : triangles_) normal.push_back((now(t.v[1]) - now(t.v[0])).cross(now(t.v[2]) - now(t.v[0])));
  const auto ring_of = [&](std::size_t i, const auto& takes) {
    std::vector<Index> ring;
    for (Index t : around_[i])
      if (takes(t))
        for (Index v : triangles_[t].v)
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
  std::vector<Node> out;
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    if (!covered[i]) continue;
    // Where no force is, that of the neighbours tells the side.
    Vec3 force = at(f.force, i);
    if (force.isZero(0))
      for (Index j : ring_of(i, [](Index) { return true; })) force += at(f.force, j);
    const auto faces = [&](Index t) { return -normal[t].dot(force) > kFacing * normal[t].norm() * force.norm(); };
    Node node{i, ring_of(i, faces), 0};
    if (node.ring.empty() || !std::all_of(node.ring.begin(), node.ring.end(), [&](Index j) { return covered[j] != 0; })) continue;
    for (Index t : around_[i])
      if (linear_[i] && faces(t)) node.area += normal[t].norm() / 6;
    out.push_back(std::move(node));
  }
  return out;
}

long ContactPatch::loaded(std::span<const double> pressure) const {
  long n = 0;
  for (std::size_t i = 0; i < std::min(rest_.size(), pressure.size()); ++i) n += !around_[i].empty() && pressure[i] > 0;
  return n;
}

}  // namespace mortise::run
