#pragma once
#include <cstddef>

namespace mortise::device {

void account(std::ptrdiff_t bytes);  // called by the backends' allocate and release

}  // namespace mortise::device
