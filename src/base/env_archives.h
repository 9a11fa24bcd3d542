#pragma once
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "base/archive.h"

namespace mortise {

// The checkpoints of several environments of one model as one: what is said of all is cut into what each would have said alone, and put together
// again. Environments without an archive are neither saved nor loaded.
class EnvArchives : public Archive {
 public:
  explicit EnvArchives(std::vector<Archive*> of) : of_(std::move(of)) {}
  bool loading() const override {
    return std::any_of(of_.begin(), of_.end(), [](const Archive* a) { return a && a->loading(); });
  }
  bool loads(int env) const override { return of_[static_cast<std::size_t>(env)] && of_[static_cast<std::size_t>(env)]->loading(); }
  void io(std::string_view name, std::vector<double>& values, const std::vector<std::size_t>& first) override {
    if (of_.size() == 1) return of_[0]->io(name, values);
    if (first.size() != of_.size() + 1) throw std::logic_error("'" + std::string(name) + "' is not of every environment");
    std::vector<double> all;
    for (std::size_t e = 0; e < of_.size(); ++e) {
      std::vector<double> own;
      if (values.size() >= first[e + 1])
        own.assign(values.begin() + static_cast<std::ptrdiff_t>(first[e]), values.begin() + static_cast<std::ptrdiff_t>(first[e + 1]));
      if (of_[e]) of_[e]->io(name, own);
      all.insert(all.end(), own.begin(), own.end());
    }
    if (loading()) values = std::move(all);
  }
  // What belongs to no environment cannot be cut.
  void io(std::string_view name, std::vector<double>& values) override {
    if (of_.size() != 1) throw std::logic_error("'" + std::string(name) + "' belongs to no environment");
    of_[0]->io(name, values);
  }
  using Archive::io;

 private:
  std::vector<Archive*> of_;
};

}  // namespace mortise
