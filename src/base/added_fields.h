#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/pass_on.h"

namespace mortise {

// Adds up what several effects report of the points under one name (two contact effects: their forces and pressures); finish() passes it on.
class AddedFields : public PassOn {
 public:
  using PassOn::PassOn;
  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override {
    const auto [it, fresh] = fields_.try_emplace(std::string(name), Field{std::string(unit), components, {}});
    std::vector<double>& sum = it->second.values;
    if (fresh) sum.assign(values.begin(), values.end());
    for (std::size_t i = 0; !fresh && i < sum.size() && i < values.size(); ++i) sum[i] += values[i];
  }
  void finish() {
    for (const auto& [name, f] : fields_) PassOn::points(name, f.unit, f.components, f.values);
    fields_.clear();
  }

 private:
  struct Field {
    std::string unit;
    int components;
    std::vector<double> values;
  };
  std::map<std::string, Field> fields_;
};

}  // namespace mortise
