#pragma once
#include <cstddef>
#include <string_view>

#include "base/error.h"

namespace mortise::device {

// What backends report of their work.
void account(std::ptrdiff_t bytes);  // allocated, or released where negative
void count_to_device(std::size_t bytes);
void count_to_host(std::size_t bytes, std::string_view who);

// `memory`: of the whole device, 0 where unknown.
Error out_of_memory(std::size_t asked, std::size_t memory);

}  // namespace mortise::device
