#pragma once
#include <utility>
#include <vector>

#include "base/field_sink.h"
#include "base/types.h"

namespace mortise {

// Where the environments of a model put their results: a sink each. What is wanted of none is dropped.
class FieldSinks {
 public:
  FieldSinks(FieldSink& only) : of_{&only} {}  // of a model with one environment
  explicit FieldSinks(std::vector<FieldSink*> of) : of_(std::move(of)) {}

  Index size() const { return static_cast<Index>(of_.size()); }
  bool wanted(Index env) const { return of_[static_cast<std::size_t>(env)] != nullptr; }
  FieldSink& operator[](Index env) const {
    static Nowhere nowhere;
    FieldSink* sink = of_[static_cast<std::size_t>(env)];
    return sink ? *sink : nowhere;
  }

  // One number of every environment.
  void scalar(std::string_view group, std::string_view name, std::string_view unit, const std::vector<double>& of) const {
    for (Index e = 0; e < size(); ++e) (*this)[e].scalar(group, name, unit, of[static_cast<std::size_t>(e)]);
  }

 private:
  struct Nowhere final : FieldSink {
    void points(std::string_view, std::string_view, int, std::span<const double>) override {}
    void cells(std::string_view, std::string_view, int, std::span<const double>) override {}
    void rows(std::string_view, std::string_view, std::string_view, int, std::span<const double>) override {}
    void scalar(std::string_view, std::string_view, std::string_view, double) override {}
  };
  std::vector<FieldSink*> of_;
};

}  // namespace mortise
