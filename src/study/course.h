#pragma once
// A model in this process with an engine of its own, and a recording of its states.
#include <memory>
#include <string>
#include <vector>

#include "engine/choose.h"
#include "engine/input.h"
#include "study/recording.h"

namespace mortise::study {

class Course {
 public:
  Course(model::ModelInput input, const std::string& file, const engine::Api& api);
  Course(const Course&) = delete;

  engine::Engine& engine() { return *engine_; }
  const model::ModelInput& input() const { return input_; }
  Recording& recording() { return *recording_; }

 private:
  const model::ModelInput input_;
  std::unique_ptr<engine::Engine> engine_;
  std::unique_ptr<Recording> recording_;
};

}  // namespace mortise::study
