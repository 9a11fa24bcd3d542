#pragma once
// Which point-triangle and edge-edge pairs may come within a radius of each other.
//
// Newton's method asks again and again from places that are next to each other. So a search finds somewhat more than it was asked for, and is
// kept: as long as no point of a question lies farther than half of that surplus from where the search was made, the answer is picked from what
// it found (a Verlet list, of every environment by itself). Whether an answer was searched or picked cannot be told from it.
#include <functional>
#include <memory>
#include <vector>

#include "geometry/collide/pair_search.h"

namespace mortise::geometry {

// All pairs whose boxes, swept from y to y + dy and grown by radius/2, overlap; without pairs that share a point and pairs that
// the surface does not watch, and of one body without those that stay farther apart than the radius (near_pairs.h). Sorted by environment, then by
// the two ids. Exactly what testing all pairs would find.
class Broadphase {
 public:
  // Keeps a reference to the surface, whose points and primitives must not change.
  explicit Broadphase(const Surface& surface);

  // y, dy [m]: one per point of the surface; dy may be empty (bodies at rest). radius >= 0 [m]. Pairs of the environments of `whose` only, or of all
  // where it is empty. Throws Error(Exit::device) when there are more pairs than can be counted.
  void update(device::View<const Vec3> y, device::View<const Vec3> dy, double radius, const std::vector<std::uint8_t>& whose = {});
  // The same answer, picked from what is kept without waiting, on the guess that it serves. Whether it did take() says once `fetch` is done: true,
  // and the answer is here, or false, and it has to be searched. y and dy must stay until then.
  struct Guess {
    bool answers = false;  // not where nothing is kept, or what was did not serve the last question: then only search() can
    ChosenPairs pairs;     // of what is kept: where the guess is right they are the answer

   private:
    friend class Broadphase;
    device::Buffer<Index> pt_counts, ee_counts;
    NearPairs sizes;
    NearPairs::Sums sums;
    std::vector<double> off, way;  // of every environment [m]: how far points are from where the list was searched, and how far they go
    std::vector<std::uint8_t> whose;
    double radius = 0;
    Index list = 0;
  };
  std::unique_ptr<Guess> guess(device::View<const Vec3> y, device::View<const Vec3> dy, double radius, const std::vector<std::uint8_t>& whose,
                               device::Fetch& fetch) const;
  bool take(Guess& guess);
  // After a guess that take() has refused: searches where what is kept does not serve. The answer is a guess, which take() accepts once `fetch` is
  // done; none where it is here already, searched on ways that are too long for more to be kept.
  //
  // A body that hardly anything holds goes so far in a step of Newton's method that everything lies on its way: more pairs than memory has room for,
  // of which the first would do. Where there is `shorten`, it is told by how much the ways of every environment are too long, until few enough lie on
  // them, and multiplies dy.
  using Shorten = std::function<void(const std::vector<double>& by)>;
  std::unique_ptr<Guess> search(device::View<const Vec3> y, device::View<const Vec3> dy, const Guess& refused, const Shorten& shorten,
                                device::Fetch& fetch);

  // The surface watches other pairs from now on.
  void forget() { kept_radius_.assign(kept_radius_.size(), -1.0); }

  device::View<const PointTriangle> point_triangles() const { return found_.point_triangles.view(); }
  device::View<const EdgeEdge> edge_edges() const { return found_.edge_edges.view(); }
  ChosenPairs pairs() const { return {{point_triangles()}, {edge_edges()}, {pt_env_offset()}, {ee_env_offset()}}; }
  // Pairs of environment e are [offset[e], offset[e+1]); as many environments as the surface's points have.
  const std::vector<Index>& pt_env_offset() const { return found_.pt_env_offset; }
  const std::vector<Index>& ee_env_offset() const { return found_.ee_env_offset; }

  // The pairs of the environments of `whose` take the place of theirs in `to`.
  void copy(const std::vector<std::uint8_t>& whose, NearPairs& to) const;

  Index searches() const { return searches_; }  // made so far, each of an environment

 private:
  using Mask = std::vector<std::uint8_t>;
  // Largest |y - from| + |dy| of the environments of `whose`, without `from` |dy|.
  void farthest(device::View<const Vec3> from, device::View<const Vec3> y, device::View<const Vec3> dy, const Mask& whose,
                device::EnvValues out) const;
  bool serves(double radius, double off, Index env) const { return radius + 2 * off <= kept_radius_[env]; }
  std::unique_ptr<Guess> ask(device::View<const Vec3> y, device::View<const Vec3> dy, double radius, const Mask& whose, bool serves,
                             device::Fetch& fetch) const;
  void keep_more(device::View<const Vec3> y, const std::vector<double>& radius, const Mask& whose);
  double most_surplus(device::View<const Vec3> y);
  void find_on_ways(device::View<const Vec3> y, device::View<const Vec3> dy, double radius, const Mask& whose, const std::vector<double>& way,
                    const Shorten& shorten, NearPairs& to);
  std::vector<double> sizes(device::View<const Vec3> y) const;

  const Surface& surface_;
  PairSearch search_;
  device::Buffer<Index> points_;  // all, environment after environment,
  std::vector<Index> point_env_;  // and where those of each begin
  NearPairs found_, kept_;
  device::Buffer<Vec3> kept_at_;
  std::vector<double> kept_radius_;  // of kept_ in every environment [m]; negative: none
  double most_surplus_ = -1;         // [m]; negative: not known yet
  Index searches_ = 0;
  Index list_ = 0;      // number of what is kept
  bool served_ = true;  // did it serve the last question?
};

}  // namespace mortise::geometry
