#include "geometry/io/ply.h"

#include <memory>

#include "geometry/io/bytes.h"
#include "geometry/io/corners.h"
#include "geometry/io/ply_header.h"

namespace mortise::geometry {
namespace {

using ply::Element;
using ply::Property;
using ply::Type;

// The values behind the header, one after the other. All types of the format fit into a double.
class Values {
 public:
  virtual ~Values() = default;
  virtual void begin(const Element&) {}      // all elements of a kind
  virtual void begin_one(const Element&) {}  // one of them
  virtual void end_one() {}
  virtual void end() = 0;  // nothing may be left: the counts of the header would be wrong
  virtual double next(Type type, const char* what) = 0;
  [[noreturn]] virtual void fail(const std::string& message) const = 0;
};

// One element per line.
class AsciiValues final : public Values {
 public:
  explicit AsciiValues(LineReader in) : in_(std::move(in)) {}
  void begin_one(const Element& e) override {
    in_.require(("an element '" + e.name + "'").c_str());
    word_ = 0;
  }
  void end_one() override {
    if (word_ < in_.words().size()) fail("expected the end of the line, found '" + std::string(in_.words()[word_]) + "'");
  }
  double next(Type, const char* what) override {
    const std::string_view word = in_.word(word_++, what);
    if (const auto value = number_from<double>(word)) return *value;
    in_.fail("expected " + std::string(what) + ", found '" + std::string(word) + "'");
  }
  void end() override {
    if (in_.next()) fail("expected the end of the file after as many elements as the header counts");
  }
  void fail(const std::string& message) const override { in_.fail(message); }

 private:
  LineReader in_;
  std::size_t word_ = 0;
};

class BinaryValues final : public Values {
 public:
  explicit BinaryValues(ByteReader in) : in_(std::move(in)) {}
  void begin(const Element& e) override {
    if (static_cast<std::size_t>(e.count) > in_.left() / e.least_bytes())
      fail("the header counts " + std::to_string(e.count) + " of element '" + e.name + "', each of " + std::to_string(e.least_bytes()) +
           " bytes or more; the file has " + std::to_string(in_.left()) + " bytes left");
  }
  double next(Type type, const char* what) override {
    switch (type) {
      case Type::i8:
        return in_.read<std::int8_t>(what);
      case Type::u8:
        return in_.read<std::uint8_t>(what);
      case Type::i16:
        return in_.read<std::int16_t>(what);
      case Type::u16:
        return in_.read<std::uint16_t>(what);
      case Type::i32:
        return in_.read<std::int32_t>(what);
      case Type::u32:
        return in_.read<std::uint32_t>(what);
      case Type::f32:
        return in_.read<float>(what);
      case Type::f64:
        break;
    }
    return in_.read<double>(what);
  }
  void end() override {
    if (in_.left() > 0)
      fail("expected the end of the file after as many elements as the header counts, found " + std::to_string(in_.left()) + " bytes more");
  }
  void fail(const std::string& message) const override { in_.fail(message); }

 private:
  ByteReader in_;
};

// The place of a vertex' property among x y z nx ny nz s t, -1 for others.
int slot(const Property& p) {
  constexpr std::pair<const char*, int> kSlots[] = {{"x", 0}, {"y", 1}, {"z", 2}, {"nx", 3}, {"ny", 4},        {"nz", 5},
                                                    {"s", 6}, {"t", 7}, {"u", 6}, {"v", 7},  {"texture_u", 6}, {"texture_v", 7}};
  for (const auto& [name, place] : kSlots)
    if (p.name == name && !p.count) return place;
  return -1;
}

// Calls on_value(value) for each value of a list, or for the only value of any other property.
template <class F>
void read_property(Values& in, const Property& p, const char* what, const F& on_value) {
  const double n = p.count ? in.next(*p.count, "the length of a list") : 1;
  if (!(n >= 0 && n <= 4294967295.0)) in.fail("the length of a list is out of range");
  for (double i = 0; i < n; ++i) on_value(in.next(p.type, what));
}

void read_vertices(Values& in, const Element& e, PlyFile& out) {
  std::vector<int> slots;
  bool has[8] = {};
  for (const Property& p : e.properties) {
    slots.push_back(slot(p));
    if (slots.back() >= 0) has[slots.back()] = true;
  }
  if (!has[0] || !has[1] || !has[2]) in.fail("element 'vertex' has no properties x, y and z");
  for (long long i = 0; i < e.count; ++i) {
    double value[8] = {};
    in.begin_one(e);
    for (std::size_t k = 0; k < slots.size(); ++k)
      read_property(in, e.properties[k], "a number", [&](double v) {
        if (slots[k] >= 0) value[slots[k]] = v;
      });
    const Vec3 point(value[0], value[1], value[2]);
    if (!point.allFinite()) in.fail("a coordinate of vertex " + std::to_string(i) + " is not a finite number");
    in.end_one();
    out.points.push_back(point);
    if (has[3] && has[4] && has[5]) out.normals.emplace_back(value[3], value[4], value[5]);
    if (has[6] && has[7]) out.uvs.emplace_back(value[6], value[7]);
  }
}

void read_faces(Values& in, const Element& e, long long vertices, PlyFile& out) {
  std::vector<Index> corners;
  for (long long i = 0; i < e.count; ++i) {
    corners.clear();
    in.begin_one(e);
    for (const Property& p : e.properties) {
      const bool wanted = p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
      read_property(in, p, "a number", [&](double v) {
        if (!wanted) return;
        if (!(v >= 0 && v < vertices) || v != static_cast<double>(static_cast<Index>(v)))
          in.fail("face " + std::to_string(i) + " names a vertex that is not there (the file has " + std::to_string(vertices) + ")");
        corners.push_back(static_cast<Index>(v));
      });
    }
    if (corners.size() < 3) in.fail("face " + std::to_string(i) + " has less than three vertices");
    in.end_one();
    for (std::size_t k = 2; k < corners.size(); ++k) out.triangles.push_back({{corners[0], corners[k - 1], corners[k]}});
  }
}

void pass_over(Values& in, const Element& e) {
  for (long long i = 0; i < e.count; ++i) {
    in.begin_one(e);
    for (const Property& p : e.properties) read_property(in, p, "a number", [](double) {});
    in.end_one();
  }
}

}  // namespace

PlyFile parse_ply(const std::string& path, std::string_view bytes) {
  LineReader lines(path, bytes);
  const ply::Header header = ply::read_header(lines);
  std::unique_ptr<Values> in;
  if (header.format == ply::Format::ascii) {
    in = std::make_unique<AsciiValues>(lines);
  } else {
    const std::endian order = header.format == ply::Format::big_endian ? std::endian::big : std::endian::little;
    in = std::make_unique<BinaryValues>(ByteReader(path, bytes, lines.offset(), order));
  }
  const Element* vertex = header.find("vertex");
  if (!vertex) lines.fail("the header describes no element 'vertex'");
  PlyFile out;
  for (const Element& e : header.elements) {
    in->begin(e);
    if (e.name == "vertex") {
      read_vertices(*in, e, out);
    } else if (e.name == "face") {
      read_faces(*in, e, vertex->count, out);
    } else {
      pass_over(*in, e);
    }
  }
  in->end();
  return out;
}

TriMesh surface_from(PlyFile ply) { return {std::move(ply.points), std::move(ply.triangles)}; }

VisualMesh visual_from(const std::string& path, const PlyFile& ply) {
  CornerCollector collector(path);
  std::vector<Index> vertex;
  for (std::size_t i = 0; i < ply.points.size(); ++i)
    vertex.push_back(
        collector.vertex(0, ply.points[i], ply.normals.empty() ? Vec3(0, 0, 0) : ply.normals[i], ply.uvs.empty() ? Vec2(0, 0) : ply.uvs[i]));
  for (const Triangle& t : ply.triangles) collector.triangle(0, 0, {{vertex[t.v[0]], vertex[t.v[1]], vertex[t.v[2]]}});
  return collector.finish({VisualMaterial{}}, !ply.uvs.empty());
}

}  // namespace mortise::geometry
