#pragma once
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "base/field_sink.h"
#include "run/progress.h"

namespace mortise::run {

// Passes a report on to the field file (or nowhere) and keeps what progress lines and pictures need.
class Tee : public FieldSink {
 public:
  explicit Tee(FieldSink* next) : next_(next) {}
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    if (next_) next_->points(name, unit, components, values);
    if (components == 1) point_fields_[std::string(name)].assign(values.begin(), values.end());
  }
  void cells(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    if (next_) next_->cells(name, unit, components, values);
  }
  void rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    if (next_) next_->rows(group, name, unit, components, values);
  }
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) override {
    if (next_) next_->scalar(group, name, unit, value);
    // Any contact effect reports these two; several add up.
    if (name == "active_pairs") contact_.pairs = std::isfinite(contact_.pairs) ? contact_.pairs + value : value;
    if (name == "min_distance") contact_.min_gap = std::isfinite(contact_.min_gap) ? std::min(contact_.min_gap, value) : value;
  }
  const std::map<std::string, std::vector<double>>& point_fields() const { return point_fields_; }
  ContactFigures contact() const { return contact_; }

 private:
  FieldSink* next_;
  std::map<std::string, std::vector<double>> point_fields_;
  ContactFigures contact_{NAN, NAN};
};

}  // namespace mortise::run
