#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/params.h"
#include "model/input.h"

namespace mortise::run {

// Draws the scene's cameras: FOLDER/<camera>_0042.png, its depth and segmentation where it writes them, and where it was (schemas/camera.md).
class Pictures {
 public:
  Pictures(const Params& scene, const model::ModelInput& input, const std::string& folder);
  ~Pictures();
  // points: 3 per point [m]; fields: of points, by name, with one or three numbers each.
  void draw(long frame, double time, const std::vector<double>& points, const std::map<std::string, std::vector<double>>& fields);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mortise::run
