#pragma once
// What a contact effect tells about its active samples at a state; friction and the solver read it. A sample is a relative
// position r = sum_k weight[k] * y[point[k]] of surface points (weights sum to 0, or to 1 against an analytic obstacle that
// does not move), with the contact force along a fixed normal.
#include <utility>

#include "linalg/stencils.h"

namespace mortise::model {

inline constexpr Index kSamplePoints = 12;  // six on each side, for samples on quadratic faces

struct ContactSample {
  Index points = 0;              // how many of the slots are used
  Index point[kSamplePoints];    // point ids
  double weight[kSamplePoints];  // slave side negative, master side positive: gap grows along +normal
  double normal[3];              // unit; force on a point with weight w is force * w * normal
  double position[3];            // where the sample sits [m]
  double force = 0;              // normal force [N]; negative where the sample takes back what others count twice
  double area = 0;               // area the sample stands for [m^2], of the force's sign; 0 where the method has none
  double stiffness = 0;          // -d force / d gap [N/m]
  double gap = 0;                // [m]
  double pressure = 0;           // [Pa], force / area where there is an area
  Index env = 0;
  Index body_a = 0, body_b = 0;  // slave (or first) and master (or second) body; obstacles count after the bodies
};

// Is the other side an obstacle that does not move? Then the normal points at the first body, else away from it. Single weights do not
// tell: shape functions of quadratic faces have both signs.
MORTISE_HD inline bool against_obstacle(const ContactSample& s) {
  double sum = 0;
  for (Index k = 0; k < s.points; ++k) sum += s.weight[k];
  return sum > 0.5;
}

// How samples change with points: by functionals z_c = sum_k along_ck . dy_k, c < functionals,
//     d force = sum_c force_c z_c,   d normal = sum_c normal_c z_c,   d weight_k = sum_c weight_ck z_c.
// Points are those of the sample, in their order; or more, after them, where neighbours take part. Of a sample whose changes are not known the force
// hangs on the gap, by its stiffness; normal and weights count as fixed.
struct SampleChangesView {
  Index functionals = 0;
  device::View<const Index> start, node;  // points of sample i: node[start[i]] ... node[start[i + 1] - 1]; empty: kUniform, of the sample
  device::View<Vec3> along_;              // [1], or as others ask for
  device::View<double> force_;            // [N/m]
  device::View<Vec3> normal_;             // [1/m]
  device::View<double> weight_;           // [1/m]
  device::View<std::uint8_t> known_;      // empty: all are
  static constexpr Index kUniform = 4;
  MORTISE_HD Index begin(Index i) const { return start.n > 0 ? start[i] : kUniform * i; }
  MORTISE_HD Index points(Index i) const { return start.n > 0 ? start[i + 1] - start[i] : kUniform; }
  MORTISE_HD Vec3* along(Index i, Index c) const { return along_.p + begin(i) * functionals + c * points(i); }
  MORTISE_HD double* weight(Index i, Index c) const { return weight_.p + begin(i) * functionals + c * points(i); }
  MORTISE_HD double& force(Index i, Index c) const { return force_[i * functionals + c]; }
  MORTISE_HD Vec3& normal(Index i, Index c) const { return normal_[i * functionals + c]; }
  MORTISE_HD bool known(Index i) const { return known_.n == 0 || known_[i] != 0; }
  MORTISE_HD void clear(Index i, Index c) const {
    force(i, c) = 0, normal(i, c) = Vec3::Zero();
    for (Index k = 0; k < points(i); ++k) along(i, c)[k] = Vec3::Zero(), weight(i, c)[k] = 0;
  }
};

inline constexpr Index kChangePoints = 32;  // that a sample may hang on

class SampleChanges {
 public:
  // partly: of which they are known is told as well.
  void resize(Index samples, Index functionals, bool partly = false) {
    start_.resize(0), node_.resize(0);
    shape(samples, functionals, SampleChangesView::kUniform * samples, partly);
  }
  // With points of their own, partly.
  void resize(Index samples, Index functionals, const device::Buffer<Index>& start, const device::Buffer<Index>& node) {
    start_.copy_from(start), node_.copy_from(node);
    shape(samples, functionals, node.size(), true);
  }
  linalg::StencilSizes sizes;  // of stencils of the points
  bool any() const { return force_.size() > 0; }
  bool scattered() const { return start_.size() > 0; }
  void copy_from(const SampleChanges& o) {
    functionals_ = o.functionals_, sizes = o.sizes;
    start_.copy_from(o.start_), node_.copy_from(o.node_);
    along_.copy_from(o.along_), force_.copy_from(o.force_), normal_.copy_from(o.normal_), weight_.copy_from(o.weight_);
    known_.copy_from(o.known_);
  }
  SampleChangesView view() {
    return {functionals_, std::as_const(start_).view(), std::as_const(node_).view(), along_.view(), force_.view(), normal_.view(), weight_.view(),
            known_.view()};
  }
  std::size_t bytes() const {
    return start_.bytes() + node_.bytes() + along_.bytes() + force_.bytes() + normal_.bytes() + weight_.bytes() + known_.bytes();
  }

 private:
  void shape(Index samples, Index functionals, Index points, bool partly) {
    functionals_ = functionals, sizes = {};
    along_.resize(functionals * points), weight_.resize(functionals * points);
    force_.resize(samples * functionals), normal_.resize(samples * functionals);
    known_.resize(partly ? samples : 0);
  }
  Index functionals_ = 0;
  device::Buffer<Index> start_, node_;
  device::Buffer<Vec3> along_, normal_;
  device::Buffer<double> force_, weight_;
  device::Buffer<std::uint8_t> known_;
};

struct ContactView {
  device::Buffer<ContactSample> samples;  // canonical order, environments contiguous
  SampleChanges changes;                  // of every sample, where that was asked for
  std::vector<Index> env_offset;          // per environment, on the host
  linalg::StencilSizes sizes;             // of stencils of every sample's points
  bool local = true;                      // the force of a sample hangs on its own gap alone, by its stiffness
};

}  // namespace mortise::model
