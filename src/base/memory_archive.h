#pragma once
#include <map>
#include <stdexcept>
#include <string>

#include "base/archive.h"

namespace mortise {

// A checkpoint kept in memory: what a step that has to be undone goes back to.
class MemoryArchive : public Archive {
 public:
  bool loading() const override { return loading_; }
  void io(std::string_view name, std::vector<double>& values) override {
    if (loading_)
      values = data_.at(std::string(name));
    else
      data_[std::string(name)] = values;
  }
  using Archive::io;
  void rewind() { loading_ = true; }
  const std::map<std::string, std::vector<double>>& data() const { return data_; }

 private:
  std::map<std::string, std::vector<double>> data_;
  bool loading_ = false;
};

// Names of one part of a checkpoint, put under "prefix/".
class PrefixedArchive : public Archive {
 public:
  PrefixedArchive(Archive& inner, std::string prefix) : inner_(inner), prefix_(std::move(prefix)) {}
  bool loading() const override { return inner_.loading(); }
  bool loads(int env) const override { return inner_.loads(env); }
  void io(std::string_view name, std::vector<double>& values) override { inner_.io(prefix_ + "/" + std::string(name), values); }
  void io(std::string_view name, std::vector<double>& values, const std::vector<std::size_t>& first) override {
    inner_.io(prefix_ + "/" + std::string(name), values, first);
  }
  using Archive::io;

 private:
  Archive& inner_;
  std::string prefix_;
};

}  // namespace mortise
