#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace mortise::output {

// What the XDMF sidecar says about a field file. It holds no data: every item points into the HDF5 file.
struct XdmfField {
  std::string name;
  bool on_cells = false;
  bool constant = false;  // one block for all frames
  int components = 1;
};

struct XdmfDescription {
  std::string hdf5_name;  // file name, relative to the sidecar
  std::vector<double> times;
  std::uint64_t points = 0, cells = 0;
  std::uint8_t uniform_type = 0;    // VTK cell type of all cells; 0: mixed, topology in /mortise/mesh/xdmf_topology
  std::uint64_t topology_size = 0;  // length of the topology array used
  int precision = 4;                // bytes per real
  std::vector<XdmfField> fields;
};

// XDMF 2 text with one grid per frame (reference: XDMF Model and Format, version 2; opens in ParaView's "XDMF Reader").
std::string xdmf_text(const XdmfDescription& d);

// XDMF topology code of a VTK cell type: 4 triangle, 6 tetrahedron, 38 quadratic tetrahedron.
std::int64_t xdmf_code(std::uint8_t vtk_type);

}  // namespace mortise::output
