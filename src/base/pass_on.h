#pragma once
#include "base/field_sink.h"

namespace mortise {

// A sink that hands everything on to `next` (which may be null); what wants to look at the results on their way overrides.
class PassOn : public FieldSink {
 public:
  explicit PassOn(FieldSink* next) : next_(next) {}
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    if (next_) next_->points(name, unit, components, values);
  }
  void cells(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    if (next_) next_->cells(name, unit, components, values);
  }
  void rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    if (next_) next_->rows(group, name, unit, components, values);
  }
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) override {
    if (next_) next_->scalar(group, name, unit, value);
  }

 private:
  FieldSink* next_;
};

}  // namespace mortise
