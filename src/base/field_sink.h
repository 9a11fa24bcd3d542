#pragma once
#include <span>
#include <string_view>

namespace mortise {

// Where effects put their results at the accepted end of a step. Names are snake_case; units SI, spelled ("Pa", "N", "m").
// Names are unique per frame; the sink decides what is kept. An effect that does not exist reports nothing.
class FieldSink {
 public:
  virtual ~FieldSink() = default;
  // One value (of `components` numbers, row-major) per output point / per output cell, in output-mesh order.
  virtual void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) = 0;
  virtual void cells(std::string_view name, std::string_view unit, int components, std::span<const double> values) = 0;
  // A table whose number of rows changes from frame to frame (contact samples): `group` names the effect.
  virtual void rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> values) = 0;
  // One number per frame.
  virtual void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) = 0;
};

}  // namespace mortise
