#pragma once
// Finds near pairs by walking trees of boxes.
#include "geometry/collide/bvh.h"
#include "geometry/collide/near_pairs.h"

namespace mortise::geometry {

class PairSearch {
 public:
  // Keeps a reference to the surface, whose points and primitives must not change.
  explicit PairSearch(const Surface& surface);

  // As Broadphase::update (broadphase.h), with a radius for every environment.
  void find(device::View<const Vec3> y, device::View<const Vec3> dy, const std::vector<double>& radius, const std::vector<std::uint8_t>& whose,
            NearPairs& out);
  // The same in two halves: how many pairs every environment has, none of which needs room yet,
  const NearPairs::Sums& count(device::View<const Vec3> y, device::View<const Vec3> dy, const std::vector<double>& radius,
                               const std::vector<std::uint8_t>& whose, NearPairs& out);
  // and the pairs.
  void fill(device::View<const Vec3> y, device::View<const Vec3> dy, NearPairs& out);
  Index environments() const { return environments_; }
  // Points and edges of an environment, which all ask for what is near them.
  Index queries(Index env) const { return point_env_offset_[env + 1] - point_env_offset_[env] + edge_env_offset_[env + 1] - edge_env_offset_[env]; }

 private:
  const Surface& surface_;
  Index environments_ = 0;
  device::Buffer<Index> points_, edges_;                                         // queries in canonical order: environment, then id
  std::vector<Index> point_env_offset_, edge_env_offset_, triangle_env_offset_;  // first query of each environment, and triangle
  Index walkers_ = 1;                                                            // of a query
  std::vector<Index> point_walkers_, edge_walkers_;                              // first walker of each environment,
  device::Buffer<Index> point_env_first_, edge_env_first_;                       // the same on the device
  device::Buffer<double> radius_;                                                // of every environment [m]
  Radius asked_;                                                                 // of the last question,
  NearPairs::Sums sums_;                                                         // and its answer
  device::Buffer<Index> pt_counts_, pt_noted_, ee_counts_, ee_noted_;            // scratch
  Bvh triangle_tree_, edge_tree_;
};

}  // namespace mortise::geometry
