#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/io/text.h"

namespace mortise::geometry::ply {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
std::size_t size_of(Type type);

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // of a list: the type of its length
};

struct Element {
  std::string name;
  long long count;
  std::vector<Property> properties;  // at least one
  int line;
  std::size_t least_bytes() const;  // of one element of a binary file: lists are empty
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  Format format;
  std::vector<Element> elements;  // in the order of the file
  const Element* find(std::string_view name) const;
};

// Leaves `in` behind the line "end_header".
Header read_header(LineReader& in);

}  // namespace mortise::geometry::ply
