#pragma once
// The pairs that can be in contact, found once per Newton iteration and reused for every position on its path; of every environment by itself.
#include <memory>

#include "device/device.h"
#include "geometry/collide/broadphase.h"

namespace mortise::effects::contact {

class Candidates {
 public:
  // reach [m]: pairs nearer than this are wanted. point_env[e]: first point of environment e.
  Candidates(geometry::Broadphase& broadphase, double reach, std::vector<Index> point_env);

  // All pairs within reach on the way from y to y + dy, of the environments of `whose` (of all where it is empty), without waiting, on the guess
  // that the broad phase has them (Broadphase::guess): once `fetch` is done take() says whether it had, and
  // then they are held; else search() has to be asked.
  std::unique_ptr<geometry::Broadphase::Guess> guess(const device::Buffer<Vec3>& y, const device::Buffer<Vec3>& dy,
                                                     const std::vector<std::uint8_t>& whose, device::Fetch& fetch) const;
  bool take(geometry::Broadphase::Guess& guess, const device::Buffer<Vec3>& y, const device::Buffer<Vec3>& dy,
            const std::vector<std::uint8_t>& whose);
  // Searches, and answers with a guess that take() accepts, or holds them already (Broadphase::search). Ways that are too long to be looked at whole
  // are shortened; share[e]: to how much of what they were.
  std::unique_ptr<geometry::Broadphase::Guess> search(const device::Buffer<Vec3>& y, device::Buffer<Vec3>& dy, const std::vector<std::uint8_t>& whose,
                                                      const geometry::Broadphase::Guess& refused, std::vector<double>& share, device::Fetch& fetch);
  // Makes sure that all pairs within reach at y are held, searching only if y lies off the path of the last search. False in
  // finite[e] where environment e has a position that is not a number. The same environments.
  void cover(const device::Buffer<Vec3>& y, std::vector<std::uint8_t>& finite, const std::vector<std::uint8_t>& whose = {});
  // The same in two halves, for those who use what is held on the guess that it is all: once `fetch` is done settle() says whether it was not, and
  // pairs had to be searched.
  struct Look {
    std::vector<std::uint8_t> whose;
    std::vector<double> off;  // how far off the path of every environment's last search; +infinity where there was none
  };
  void look(const device::Buffer<Vec3>& y, const std::vector<std::uint8_t>& whose, Look& to, device::Fetch& fetch) const;
  bool settle(const device::Buffer<Vec3>& y, const Look& look, std::vector<std::uint8_t>& finite);

  device::View<const geometry::PointTriangle> point_triangles() const { return pairs_.point_triangles.view(); }
  device::View<const geometry::EdgeEdge> edge_edges() const { return pairs_.edge_edges.view(); }
  device::Ranges of_points(const std::vector<std::uint8_t>& whose) const { return {pairs_.pt_env_offset, whose}; }
  device::Ranges of_edges(const std::vector<std::uint8_t>& whose) const { return {pairs_.ee_env_offset, whose}; }
  const std::vector<Index>& pt_env_offset() const { return pairs_.pt_env_offset; }
  const std::vector<Index>& ee_env_offset() const { return pairs_.ee_env_offset; }
  device::View<const Index> pt_env_first() const { return pairs_.pt_env_first.view(); }  // the same where kernels can read it
  device::View<const Index> ee_env_first() const { return pairs_.ee_env_first.view(); }
  const geometry::Broadphase& broadphase() const { return broadphase_; }  // as search() left it
  std::size_t bytes() const { return pairs_.point_triangles.bytes() + pairs_.edge_edges.bytes() + y0_.bytes() + dy_.bytes(); }

 private:
  void hold(const device::Buffer<Vec3>& y, const device::Buffer<Vec3>* dy, const std::vector<std::uint8_t>& whose);
  double radius() const;

  geometry::Broadphase& broadphase_;  // shared with other contact effects, therefore the results are copied
  double reach_;
  std::vector<Index> point_env_;
  std::vector<std::uint8_t> held_;  // environments whose pairs are there
  device::Buffer<Vec3> y0_, dy_;    // path of every environment's last search
  geometry::NearPairs pairs_;
};

}  // namespace mortise::effects::contact
