#pragma once
// What contact effects report in the same words.
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/field_sinks.h"
#include "device/device.h"
#include "model/contact_view.h"
#include "model/model.h"

namespace mortise::effects::contact {

// Two bodies, the lower number first; half-spaces count after the bodies.
using BodyPair = std::pair<Index, Index>;

// Forces on points [N], their sum per body, and the wrench of every pair of bodies in contact.
class PointForces {
 public:
  // y: where the points are.
  PointForces(const model::Model& model, const device::Buffer<Vec3>& y);
  // The force on a point that body or half-space `from` exerts.
  void add(Index point, const Vec3& force, Index from);
  Index body(Index point) const { return body_[point]; }
  const std::vector<double>& force() const { return force_; }  // 3 per point [N]
  const std::vector<Vec3>& places() const { return y_; }
  // Force on the first body of a pair [N]; zero where the pair does not touch.
  Vec3 on_first(const BodyPair& pair) const;
  void report(const FieldSinks& sinks, std::string_view group) const;

 private:
  struct Wrench {  // on the first body; moment about the origin of the world
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  };
  const model::Model& model_;
  std::vector<Index> body_;
  std::vector<Vec3> y_;
  std::vector<double> force_;  // 3 per point
  std::vector<Vec3> resultant_;
  std::map<BodyPair, Wrench> pairs_;
};

// One row per sample, of one environment.
class SampleRows {
 public:
  SampleRows(const model::Model& model, Index env) : model_(&model), env_(env) {}
  void add(const model::ContactSample& s);
  // Names of columns begin with `prefix`.
  void report(FieldSink& sink, std::string_view group, const std::string& prefix = "") const;

  // Sum over the samples of a pair: of the force on the first body, and of its magnitudes [N].
  struct Sum {
    Vec3 force = Vec3::Zero();
    double size = 0;
  };
  const std::map<BodyPair, Sum>& sums() const { return sums_; }

 private:
  const model::Model* model_;
  Index env_;
  std::vector<double> position_, normal_, force_, area_, gap_, pressure_, bodies_;
  std::map<BodyPair, Sum> sums_;
};

// How far the samples' forces (pressure times area, where there is an area) are from adding up to the forces on the points: the largest
// difference of any pair of bodies, over the sum of the magnitudes of its samples' forces.
double sum_defect(const PointForces& forces, const std::vector<const SampleRows*>& samples);

}  // namespace mortise::effects::contact
