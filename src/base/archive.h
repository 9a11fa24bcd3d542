#pragma once
#include <string_view>
#include <vector>

namespace mortise {

// One pass over everything a restart needs; the same code saves and loads. Doubles only: they carry indices exactly to 2^53.
class Archive {
 public:
  virtual ~Archive() = default;
  virtual bool loading() const = 0;
  virtual void io(std::string_view name, std::vector<double>& values) = 0;
  void io(std::string_view name, double& value) {
    std::vector<double> v{value};
    io(name, v);
    value = v.at(0);
  }
};

}  // namespace mortise
