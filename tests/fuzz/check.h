#pragma once
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "base/types.h"

namespace mortise {

// Ends the program, which libFuzzer reports, when an element names a point that is not there.
template <class Elements>
void within(const Elements& elements, std::size_t points) {
  for (const auto& e : elements)
    for (Index v : e.v)
      if (v < 0 || static_cast<std::size_t>(v) >= points) std::abort();
}

template <class Mesh>
void sound(const Mesh& mesh) {
  within(mesh.triangles, mesh.points.size());
}

// Hands the bytes to read(std::string_view), which may throw Error and nothing else; what libFuzzer wants returned.
template <class Read>
int try_bytes(const std::uint8_t* data, std::size_t size, const Read& read) try {
  read(std::string_view(reinterpret_cast<const char*>(data), size));
  return 0;
} catch (const Error&) {
  return 0;
}

}  // namespace mortise
