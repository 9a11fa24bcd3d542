#pragma once
// What contact effects report in the same words.
#include <string_view>
#include <vector>

#include "base/field_sink.h"
#include "model/contact_view.h"
#include "model/model.h"

namespace mortise::effects::contact {

// Forces on points [N], and their sum per body.
class PointForces {
 public:
  explicit PointForces(const model::Model& model);
  void add(Index point, const Vec3& force);
  double size(Index point) const;  // magnitude of the force on a point [N]
  void report(FieldSink& sink, std::string_view group) const;

 private:
  const model::Model& model_;
  std::vector<Index> body_;
  std::vector<double> force_;  // 3 per point
  std::vector<Vec3> resultant_;
};

// One row per sample.
class SampleRows {
 public:
  void add(const model::ContactSample& s);
  void report(FieldSink& sink, std::string_view group) const;

 private:
  std::vector<double> position_, normal_, force_, area_, gap_, pressure_, bodies_;
};

}  // namespace mortise::effects::contact
