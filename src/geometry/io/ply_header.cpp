#include "geometry/io/ply_header.h"

#include <algorithm>
#include <limits>

namespace mortise::geometry::ply {
namespace {

// Both families of names that are in use.
constexpr const char* kNames[][2] = {{"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
                                     {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};

Type read_type(const LineReader& in, std::size_t word) {
  const std::string_view name = in.word(word, "a type");
  for (std::size_t i = 0; i < std::size(kNames); ++i)
    if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<Type>(i);
  in.fail("expected a type (char, uchar, short, ushort, int, uint, float, double), found '" + std::string(name) + "'");
}

Format read_format(const LineReader& in) {
  const std::string_view name = in.word(1, "a format"), version = in.word(2, "a version");
  if (version != "1.0") in.fail("version " + std::string(version) + " is not supported (1.0)");
  if (name == "ascii") return Format::ascii;
  if (name == "binary_little_endian") return Format::little_endian;
  if (name == "binary_big_endian") return Format::big_endian;
  in.fail("expected a format (ascii, binary_little_endian, binary_big_endian), found '" + std::string(name) + "'");
}

Element read_element(const LineReader& in, const Header& header) {
  Element e{std::string(in.word(1, "the name of an element")), in.integer(2, "the number of elements"), {}, in.line()};
  if (header.find(e.name)) in.fail("element '" + e.name + "' is described twice");
  if (e.count < 0 || e.count > std::numeric_limits<Index>::max()) in.fail("the number of elements is out of range: " + std::to_string(e.count));
  return e;
}

Property read_property(const LineReader& in, const Element& element) {
  const bool list = in.word(1, "a type") == "list";
  Property p{std::string(in.word(list ? 4 : 2, "the name of a property")), read_type(in, list ? 3 : 1), {}};
  if (list) p.count = read_type(in, 2);
  for (const Property& other : element.properties)
    if (other.name == p.name) in.fail("property '" + p.name + "' is described twice");
  return p;
}

}  // namespace

std::size_t size_of(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<int>(type)];
}

std::size_t Element::least_bytes() const {
  std::size_t sum = 0;
  for (const Property& p : properties) sum += size_of(p.count.value_or(p.type));
  return sum;
}

const Element* Header::find(std::string_view name) const {
  const auto at = std::find_if(elements.begin(), elements.end(), [&](const Element& e) { return e.name == name; });
  return at == elements.end() ? nullptr : &*at;
}

Header read_header(LineReader& in) {
  Header header;
  std::optional<Format> format;
  if (!in.next() || in.words()[0] != "ply") in.fail("not a PLY file: it does not begin with 'ply'");
  for (in.require("'end_header'"); in.words()[0] != "end_header"; in.require("'end_header'")) {
    const std::string_view key = in.words()[0];
    if (key == "format") {
      format = read_format(in);
    } else if (key == "element") {
      header.elements.push_back(read_element(in, header));
    } else if (key == "property") {
      if (header.elements.empty()) in.fail("a property before the first element");
      Element& e = header.elements.back();
      e.properties.push_back(read_property(in, e));
    } else if (key != "comment" && key != "obj_info") {
      in.fail("expected 'format', 'element', 'property', 'comment' or 'end_header', found '" + std::string(key) + "'");
    }
  }
  if (!format) in.fail("the header does not name the format");
  for (const Element& e : header.elements)
    if (e.properties.empty()) in.fail_at(e.line, "element '" + e.name + "' has no properties");
  header.format = *format;
  return header;
}

}  // namespace mortise::geometry::ply
