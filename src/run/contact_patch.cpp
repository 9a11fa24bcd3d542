#include "run/contact_patch.h"

#include <algorithm>

namespace mortise::run {

ContactPatch::ContactPatch(const model::ModelInput& input) {
  for (const model::BodyInput& in : input.bodies) {
    if (in.type == model::BodyType::half_space) continue;
    const Index first = static_cast<Index>(ring_.size());
    ring_.resize(ring_.size() + in.nodes.size());
    rest_.insert(rest_.end(), in.nodes.begin(), in.nodes.end());
    if (in.type != model::BodyType::soft) continue;
    for (const Triangle& t : in.triangles) {
      for (int k = 0; k < 3; ++k)
        for (int other : {(k + 1) % 3, (k + 2) % 3}) ring_[first + t.v[k]].push_back(first + t.v[other]);
      if (in.midsides.empty()) triangles_.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
    }
  }
  for (std::vector<Index>& ring : ring_) {
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  }
}

std::vector<ContactPatch::Node> ContactPatch::interior(std::span<const double> pressure) const {
  const auto bare = [&](Index j) { return !(pressure[j] > 0); };
  std::vector<std::uint8_t> covered(ring_.size(), 0);
  for (std::size_t i = 0; i < ring_.size(); ++i)
    covered[i] = !ring_[i].empty() && (!bare(static_cast<Index>(i)) ||
                                       2 * std::count_if(ring_[i].begin(), ring_[i].end(), bare) < static_cast<std::ptrdiff_t>(ring_[i].size()));
  std::vector<Node> out;
  for (std::size_t i = 0; i < ring_.size(); ++i)
    if (covered[i] && std::all_of(ring_[i].begin(), ring_[i].end(), [&](Index j) { return covered[j] != 0; })) out.push_back({i, ring_[i]});
  return out;
}

long ContactPatch::loaded(std::span<const double> pressure) const {
  long n = 0;
  for (std::size_t i = 0; i < ring_.size(); ++i) n += !ring_[i].empty() && pressure[i] > 0;
  return n;
}

}  // namespace mortise::run
