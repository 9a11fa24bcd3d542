#pragma once
#include <string>
#include <string_view>

#include "geometry/mesh.h"

namespace mortise::geometry {

// Separate triangles, as an STL file has them.
struct StlFile {
  struct Facet {
    Vec3 normal;  // as in the file: often zero, not always finite
    Vec3 corner[3];
    Index part;  // "solid" of an ASCII file
  };
  std::vector<Facet> facets;
};

// Binary and ASCII STL (https://en.wikipedia.org/wiki/STL_(file_format)); colours are passed over. A file whose size is the one that its count of
// triangles asks for is binary, even if its header begins with "solid". Errors name the file and the line or byte.
StlFile parse_stl(const std::string& path, std::string_view bytes);

TriMesh surface_from(const StlFile& stl);
VisualMesh visual_from(const std::string& path, const StlFile& stl);

}  // namespace mortise::geometry
