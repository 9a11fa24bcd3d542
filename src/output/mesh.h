#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/types.h"

namespace mortise::output {

// VTK cell codes that mortise writes.
enum CellType : std::uint8_t { triangle = 5, tetrahedron = 10, quadratic_tetrahedron = 24 };

// The mesh that fields live on: all bodies in one unstructured grid whose topology never changes during a run.
struct OutputMesh {
  std::vector<Vec3> points;                // at rest [m]
  std::vector<std::int64_t> connectivity;  // point ids, cell after cell
  std::vector<std::int64_t> offsets;       // cells + 1, into connectivity
  std::vector<std::uint8_t> types;         // CellType, one per cell
  std::vector<int> body_of_cell;
  std::vector<int> body_of_point;
  std::vector<std::string> body_names;

  std::size_t cells() const { return types.size(); }
};

}  // namespace mortise::output
