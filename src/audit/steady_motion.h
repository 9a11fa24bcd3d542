#pragma once
// What goes on as it went from the start has energy that no time step takes, and whoever goes along sees nothing of: it is no measure of what
// vibrates in it. Along every axis a body's velocity has stayed between two values; of these the nearest to zero is one that it never lost, and
//
//     E = 1/2 m |v|^2 - 1/2 m |r|^2,     v: the largest, r: how far it was from that one, along every axis the most (of all steps)
//
// is the energy of going that way, which losses are not held against.
#include <algorithm>
#include <cmath>
#include <vector>

#include "audit/archived.h"
#include "audit/moving_body.h"

namespace mortise::audit {

class SteadyMotion {
 public:
  void state(const std::vector<MovingBody>& bodies) {
    of_.resize(bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      Body& of = of_[i];
      of.mass = bodies[i].body.mass(), of.moved = std::max(of.moved, bodies[i].energy());
      for (int k = 0; k < 3; ++k) of.lo[k] = std::min(of.lo[k], bodies[i].v[k]), of.hi[k] = std::max(of.hi[k], bodies[i].v[k]);
    }
  }
  double sum() const {  // of all bodies [J]
    double sum = 0;
    for (std::size_t i = 0; i < of_.size(); ++i) sum += of(i);
    return sum;
  }
  double of(std::size_t body) const {
    if (body >= of_.size()) return 0;
    const Body& b = of_[body];
    double left = 0;
    for (int k = 0; k < 3; ++k) {
      const double far = b.lo[k] < 0 && b.hi[k] > 0 ? std::max(-b.lo[k], b.hi[k]) : b.hi[k] - b.lo[k];
      left += 0.5 * b.mass * far * far;
    }
    return std::max(b.moved - left, 0.0);
  }
  void checkpoint(Archive& archive) { archive_all(archive, "steady", of_); }

 private:
  struct Body {
    double mass = 0, moved = 0;  // the largest energy of its motion [J]
    double lo[3] = {INFINITY, INFINITY, INFINITY}, hi[3] = {-INFINITY, -INFINITY, -INFINITY};
  };
  std::vector<Body> of_;
};

}  // namespace mortise::audit
