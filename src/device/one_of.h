#pragma once
#include "device/device.h"

namespace mortise::device {

// v[i], copied from the device; it waits. For messages, not for loops.
template <class T>
T one_of(View<const T> v, Index i) {
  T value;
  copy_out(&value, v.p + i, sizeof(T));
  return value;
}

}  // namespace mortise::device
