#pragma once
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "base/pass_on.h"
#include "run/progress.h"

namespace mortise::run {

// Passes a report on to the field file (or nowhere) and keeps what progress lines and pictures need.
class Tee : public PassOn {
 public:
  using PassOn::PassOn;
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    PassOn::points(name, unit, components, values);
    if (components == 1) point_fields_[std::string(name)].assign(values.begin(), values.end());
  }
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) override {
    PassOn::scalar(group, name, unit, value);
    // Any contact effect reports these two; several add up.
    if (name == "active_pairs") contact_.pairs = std::isfinite(contact_.pairs) ? contact_.pairs + value : value;
    if (name == "min_distance") contact_.min_gap = std::isfinite(contact_.min_gap) ? std::min(contact_.min_gap, value) : value;
  }
  const std::map<std::string, std::vector<double>>& point_fields() const { return point_fields_; }
  ContactFigures contact() const { return contact_; }

 private:
  std::map<std::string, std::vector<double>> point_fields_;
  ContactFigures contact_{NAN, NAN};
};

}  // namespace mortise::run
