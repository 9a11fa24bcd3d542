#include "study/course.h"

namespace mortise::study {

Course::Course(model::ModelInput input, const std::string& file, const engine::Api& api) : input_(std::move(input)) {
  check(api.create(input_, engine_));
  recording_ = std::make_unique<Recording>(*engine_, input_, file);
}

}  // namespace mortise::study
