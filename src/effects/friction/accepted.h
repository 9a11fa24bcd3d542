#pragma once
// What friction did in the last step that every environment accepted, and all it has dissipated.
#include <vector>

#include "base/archive.h"
#include "base/field_sinks.h"
#include "effects/friction/slips.h"
#include "model/model.h"

namespace mortise::effects::friction {

class Accepted {
 public:
  explicit Accepted(const model::Model& model);
  // The environments that the step belongs to accept q; env_offset: of the samples of `slips`, dt: of each environment's step [s].
  void take(const StepInfo& info, const Slips& slips, const device::Buffer<ContactSample>& samples, const std::vector<Index>& env_offset,
            const std::vector<double>& dt, Positions q);
  void report(const FieldSinks& sinks) const;
  void checkpoint(Archive& archive);

 private:
  const model::Model& model_;
  device::Buffer<ContactSample> samples_;
  std::vector<Rub> rubs_;  // theirs
  std::vector<Index> env_offset_;
  std::vector<double> power_, dissipated_;  // of every environment [W], [J]
};

}  // namespace mortise::effects::friction
