#pragma once
// Bounding volume hierarchy over swept primitives: leaves in Morton order (environment first), and above them a complete 4-ary
// tree whose node i of level k covers leaves [i 4^k, (i+1) 4^k). The shape is implicit, so the tree is built bottom-up by one
// kernel per level and traversed without a stack or pointers. The order of the leaves only affects speed, never what is found.
#include <cmath>

#include "device/device.h"
#include "geometry/surface.h"

namespace mortise::geometry {

// A node, a leaf (`id` is then the primitive) or, on the other side of the test, a query.
struct alignas(16) BvhNode {
  double lo[3], hi[3];   // [m]
  Index env_lo, env_hi;  // environments below
  Index body;            // the body of all primitives below, -1 if several
  Index id;              // largest primitive id below; in a query: only larger ids are wanted
};

inline constexpr int kBvhLevels = 17;

struct BvhView {
  device::View<const BvhNode> nodes;
  int levels = 0;                // level 0 holds the leaves, level levels-1 the root
  Index start[kBvhLevels] = {};  // first node of each level
  Index size[kBvhLevels] = {};
  device::View<const Index> env_first;  // first leaf of every environment, and their number
};

// Edges or triangles as rows of `corners` point ids.
struct Primitives {
  const Index* v = nullptr;
  Index n = 0;
  int corners = 0;
};

// The box of primitive `id` moving from y to y + dy (dy may be empty), grown by `grow` on every side.
MORTISE_HD inline BvhNode swept_box(const Index* v, int corners, Index id, const SurfaceView& s, device::View<const Vec3> y,
                                    device::View<const Vec3> dy, double grow) {
  BvhNode b{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, s.env[v[0]], s.env[v[0]], s.body[v[0]], id};
  for (int c = 0; c < corners; ++c) {
    const Vec3 from = y[v[c]];
    Vec3 to = from;
    if (dy.n) to += dy[v[c]];
    for (int d = 0; d < 3; ++d) {
      const double lo = from[d] < to[d] ? from[d] : to[d], hi = from[d] < to[d] ? to[d] : from[d];
      if (lo < b.lo[d]) b.lo[d] = lo;
      if (hi > b.hi[d]) b.hi[d] = hi;
    }
  }
  for (int d = 0; d < 3; ++d) b.lo[d] -= grow, b.hi[d] += grow;
  return b;
}

// All bounds are read before anything hangs on one of them: a GPU would wait for memory at every branch.
MORTISE_HD inline bool boxes_overlap(const BvhNode& a, const BvhNode& b) {
  bool apart = false;
  for (int d = 0; d < 3; ++d) apart |= !(a.lo[d] <= b.hi[d]) | !(b.lo[d] <= a.hi[d]);
  return !apart;
}

// True if something below `node` may pair with `query`; exact on leaves.
MORTISE_HD inline bool may_pair(const BvhNode& node, const BvhNode& query, const SurfaceView& s) {
  const bool wanted = (node.env_lo <= query.env_lo) & (query.env_lo <= node.env_hi) & (node.id > query.id);
  return (boxes_overlap(node, query) & wanted) && (node.body < 0 || s.pair_allowed[s.pairs.of(query.body, node.body)] != 0);
}

// Walks the leaves that pair with a query, in leaf order. It begins at the few highest nodes over the leaves of the query's environment alone.
// Several may share the walk: each passes by the lowest nodes of the others, which are dealt out in turn, as what is near a query lies together.
struct BvhCursor {
  Index part = 0, parts = 1;  // which of how many, a power of two
  int level = -1;             // -1: not started
  Index i = 0;
  int top = 0;     // level of the nodes that it begins at,
  Index last = 0;  // and the last of these

  // The next primitive, or -1 at the end.
  MORTISE_HD Index next(const BvhView& t, const BvhNode& query, const SurfaceView& s) {
    if (t.levels == 0) return -1;
    bool forward = level >= 0;
    if (!forward) {
      const Index begin = t.env_first[query.env_lo], end = t.env_first[query.env_lo + 1];
      if (begin == end) return -1;
      while (((end - 1) >> 2 * top) - (begin >> 2 * top) >= 4) ++top;
      level = top, i = begin >> 2 * top, last = (end - 1) >> 2 * top;
    }
    for (;;) {
      if (forward) {
        while (level < top && (i & 3) == 3) ++level, i >>= 2;
        if (level == top && i == last) return -1;
        ++i;
      }
      forward = true;
      if (i >= t.size[level]) {
        i |= 3;  // no siblings left
        continue;
      }
      if (level <= 1 && ((level == 0 ? i >> 2 : i) & (parts - 1)) != part) continue;
      const BvhNode& node = t.nodes[t.start[level] + i];
      if (!may_pair(node, query, s)) continue;
      if (level == 0) return node.id;
      --level, i <<= 2;
      forward = false;
    }
  }
};

// A length of every environment, or one for all of them.
struct Radius {
  double all = 0;  // [m], where `each` is empty
  device::View<const double> each{};
  MORTISE_HD double operator[](Index env) const { return each.n > 0 ? each[env] : all; }
};

// By how much boxes are grown on every side: what each primitive says, or half of its environment's radius.
struct Growth {
  device::View<const double> own{};
  Radius radius{};
  MORTISE_HD double of(Index primitive, Index env) const { return own.n > 0 ? own[primitive] : radius[env] / 2; }
};

class Bvh {
 public:
  // Boxes of the primitives moving from y to y + dy; primitives and surface must be those of earlier calls. `whose`: those of some environments,
  // where those of each lie together; the boxes of the others stay as they were.
  void update(const Primitives& primitives, const SurfaceView& surface, Index environments, device::View<const Vec3> y, device::View<const Vec3> dy,
              Growth growth = {}, const device::Ranges* whose = nullptr);
  BvhView view() const;

 private:
  device::Buffer<Index> order_;  // primitive of each leaf
  device::Buffer<Index> env_first_;
  device::Buffer<BvhNode> nodes_;
  BvhView shape_;
  double age_ = -1;  // updates since the leaves were ordered, those of some environments by their share of the leaves; negative: never
};

}  // namespace mortise::geometry
