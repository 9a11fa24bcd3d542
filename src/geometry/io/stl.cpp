#include "geometry/io/stl.h"

#include <limits>

#include "geometry/io/bytes.h"
#include "geometry/io/corners.h"
#include "geometry/io/text.h"

namespace mortise::geometry {
namespace {

constexpr std::size_t kHeader = 80, kCount = 4, kFacet = 50;

std::uint64_t size_of(std::uint64_t triangles) { return kHeader + kCount + kFacet * triangles; }

bool is_binary(std::string_view bytes) {
  if (bytes.size() >= kHeader + kCount && size_of(ByteReader("", bytes, kHeader).read<std::uint32_t>("")) == bytes.size()) return true;
  const std::size_t word = bytes.find_first_not_of(" \t\r\n");
  return word == std::string_view::npos || bytes.substr(word, 5) != "solid" || bytes.find('\0') != std::string_view::npos;
}

StlFile parse_binary(const std::string& path, std::string_view bytes) {
  ByteReader in(path, bytes);
  if (bytes.size() < kHeader + kCount)
    in.fail("not an STL file: it neither begins with 'solid' nor has the " + std::to_string(kHeader + kCount) + " bytes of a binary header");
  in.raw(kHeader, "the header");
  const std::uint32_t n = in.read<std::uint32_t>("the number of triangles");
  if (size_of(n) != bytes.size())
    in.fail("the header counts " + std::to_string(n) + " triangles, which makes a file of " + std::to_string(size_of(n)) + " bytes; this one has " +
            std::to_string(bytes.size()));
  if (n > std::numeric_limits<Index>::max() / 3) in.fail("too many triangles: " + std::to_string(n));

  const auto vec3 = [&](const char* what) {
    Vec3 v;
    for (int k = 0; k < 3; ++k) v[k] = in.read<float>(what);
    return v;
  };
  StlFile stl;
  stl.facets.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    StlFile::Facet& f = stl.facets[i];
    f.normal = vec3("a normal");
    for (Vec3& corner : f.corner) {
      corner = vec3("a coordinate");
      if (!corner.allFinite()) in.fail("a coordinate of triangle " + std::to_string(i) + " is not a finite number");
    }
    f.part = 0;
    in.raw(2, "the attribute of a triangle");
  }
  return stl;
}

class AsciiParser {
 public:
  AsciiParser(const std::string& path, std::string_view text) : in_(path, text) {}

  StlFile parse() {
    int solid = 0;  // line of the one that is open
    for (Index part = -1; in_.next();) {
      const std::string_view key = in_.words()[0];
      if (key == "solid" && !solid) {
        solid = in_.line();
        ++part;
      } else if (key == "endsolid" && solid) {
        solid = 0;
      } else if (key == "facet" && solid) {
        add_facet(part);
      } else {
        in_.fail(std::string("expected ") + (solid ? "'facet' or 'endsolid'" : "'solid'") + ", found '" + std::string(key) + "'");
      }
    }
    if (solid) in_.fail_at(solid, "this solid has no 'endsolid'");
    return std::move(stl_);
  }

 private:
  void expect(const char* word) {
    in_.require((std::string("'") + word + "'").c_str());
    if (in_.words()[0] != word) in_.fail(std::string("expected '") + word + "', found '" + std::string(in_.words()[0]) + "'");
  }
  void add_facet(Index part) {
    StlFile::Facet f{Vec3::Zero(), {}, part};
    // Programs write "nan" for the normal of a needle.
    for (int k = 0; k < 3; ++k) f.normal[k] = number_from<double>(in_.word(2 + k, "a normal component")).value_or(0);
    expect("outer");
    for (Vec3& corner : f.corner) {
      expect("vertex");
      corner = in_.vec3(1, "a coordinate");
    }
    expect("endloop");
    expect("endfacet");
    stl_.facets.push_back(f);
  }

  LineReader in_;
  StlFile stl_;
};

}  // namespace

StlFile parse_stl(const std::string& path, std::string_view bytes) {
  return is_binary(bytes) ? parse_binary(path, bytes) : AsciiParser(path, bytes).parse();
}

TriMesh surface_from(const StlFile& stl) {
  TriMesh mesh;
  for (const StlFile::Facet& f : stl.facets) {
    const Index first = static_cast<Index>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), f.corner, f.corner + 3);
    mesh.triangles.push_back({{first, first + 1, first + 2}});
  }
  return mesh;
}

VisualMesh visual_from(const std::string& path, const StlFile& stl) {
  CornerCollector collector(path);
  for (const StlFile::Facet& f : stl.facets) {
    Triangle t;
    for (int k = 0; k < 3; ++k) t.v[k] = collector.vertex(f.part, f.corner[k], f.normal, Vec2(0, 0));
    collector.triangle(f.part, 0, t);
  }
  return collector.finish({VisualMaterial{}}, false);
}

}  // namespace mortise::geometry
