#pragma once
// Structures that consist of doubles alone, in an archive.
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "base/archive.h"

namespace mortise::audit {

template <class T>
void archive_all(Archive& archive, const std::string& name, std::vector<T>& of) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(double) == 0);
  std::vector<double> flat(sizeof(T) / sizeof(double) * of.size());
  if (!flat.empty()) std::memcpy(flat.data(), of.data(), sizeof(double) * flat.size());
  archive.io(name, flat);
  if (!archive.loading()) return;
  of.resize(flat.size() * sizeof(double) / sizeof(T));
  if (!flat.empty()) std::memcpy(static_cast<void*>(of.data()), flat.data(), sizeof(double) * flat.size());
}

}  // namespace mortise::audit
