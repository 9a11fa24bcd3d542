#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/field_sink.h"

namespace mortise {

// What was reported of one state, kept once for all who write, judge, draw or measure it.
class Snapshot : public FieldSink {
 public:
  struct Values : std::vector<double> {
    std::string unit;
    int components = 1;
  };
  std::map<std::string, Values> point, cell;
  std::map<std::string, Values> row;     // by "group/name"
  std::map<std::string, double> number;  // by "group/name"

  double at(const std::string& name) const;  // of `number`; NaN where nobody reported it
  bool has(const std::string& name) const { return number.count(name) > 0; }
  // Values of points with so many components; null where nobody reported them.
  const Values* of_points(const std::string& name, int components) const;
  std::map<std::string, std::vector<double>> drawable() const;  // those with one or three

  void points(std::string_view name, std::string_view unit, int components, std::span<const double> values) override;
  void cells(std::string_view name, std::string_view unit, int components, std::span<const double> values) override;
  void rows(std::string_view group, std::string_view name, std::string_view unit, int components, std::span<const double> values) override;
  void scalar(std::string_view group, std::string_view name, std::string_view unit, double value) override;
  // Tells it all again, in the order in which it was reported.
  void report(FieldSink& to) const;

 private:
  enum class Kind { point, cell, row, number };
  struct Entry {
    Kind kind;
    std::string group, name, unit;
  };
  std::vector<Entry> order_;
};

// "group/name" in two.
inline std::string group_of(const std::string& name) { return name.substr(0, name.find('/')); }
inline std::string leaf_of(const std::string& name) { return name.substr(name.find('/') + 1); }

}  // namespace mortise
