#include "output/xdmf.h"

#include <cstdio>
#include <stdexcept>

#include "base/error.h"
#include "output/mesh.h"

namespace mortise::output {
namespace {

struct Shape {
  const char* xdmf_name;
  std::int64_t code;
};

Shape shape_of(std::uint8_t vtk_type) {
  switch (vtk_type) {
    case triangle:
      return {"Triangle", 4};
    case tetrahedron:
      return {"Tetrahedron", 6};
    case quadratic_tetrahedron:
      return {"Tetrahedron_10", 38};
  }
  throw Error(Exit::internal, "output mesh: cell type " + std::to_string(vtk_type) + " has no XDMF name");
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

// Rows [first, first + count) of a dataset of `total` rows.
std::string slab(const std::string& location, std::uint64_t first, std::uint64_t count, std::uint64_t total, int components, int precision) {
  const std::string c = std::to_string(components), n = std::to_string(count);
  return "<DataItem ItemType=\"HyperSlab\" Dimensions=\"" + n + " " + c + "\" Type=\"HyperSlab\">" + "<DataItem Dimensions=\"3 " +
         std::string(components > 1 ? "2" : "1") + "\" Format=\"XML\">" + std::to_string(first) + (components > 1 ? " 0 1 1 " : " 1 ") + n +
         (components > 1 ? " " + c : "") + "</DataItem>" + "<DataItem Dimensions=\"" + std::to_string(total) + (components > 1 ? " " + c : "") +
         "\" NumberType=\"Float\" Precision=\"" + std::to_string(precision) + "\" Format=\"HDF\">" + location + "</DataItem></DataItem>";
}

std::string topology(const XdmfDescription& d, const std::string& file) {
  const bool uniform = d.uniform_type != 0;
  const std::string cells = std::to_string(d.cells);
  std::string text = "<Topology TopologyType=\"" + std::string(uniform ? shape_of(d.uniform_type).xdmf_name : "Mixed") + "\" NumberOfElements=\"" +
                     cells + "\"><DataItem Dimensions=\"";
  text += uniform ? cells + " " + std::to_string(d.cells > 0 ? d.topology_size / d.cells : 0) : std::to_string(d.topology_size);
  return text + "\" NumberType=\"Int\" Precision=\"8\" Format=\"HDF\">" + file +
         (uniform ? ":/VTKHDF/Connectivity" : ":/mortise/mesh/xdmf_topology") + "</DataItem></Topology>";
}

}  // namespace

std::int64_t xdmf_code(std::uint8_t vtk_type) { return shape_of(vtk_type).code; }

std::string xdmf_text(const XdmfDescription& d) {
  const std::string file = escaped(d.hdf5_name);
  const std::string mesh = topology(d, file);
  const std::uint64_t frames = d.times.size();
  std::string text =
      "<?xml version=\"1.0\" ?>\n<!DOCTYPE Xdmf SYSTEM \"Xdmf.dtd\" []>\n<Xdmf Version=\"2.0\"><Domain>\n"
      "<Grid Name=\"frames\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::uint64_t f = 0; f < frames; ++f) {
    char time[64];
    std::snprintf(time, sizeof time, "%.17g", d.times[f]);
    text += "<Grid Name=\"frame_" + std::to_string(f) + "\" GridType=\"Uniform\"><Time Value=\"" + time + "\"/>\n" + mesh +
            "\n<Geometry GeometryType=\"XYZ\">" + slab(file + ":/VTKHDF/Points", f * d.points, d.points, frames * d.points, 3, d.precision) +
            "</Geometry>\n";
    for (const XdmfField& field : d.fields) {
      const std::uint64_t n = field.on_cells ? d.cells : d.points;
      const char* type = field.components == 1 ? "Scalar" : field.components == 3 ? "Vector" : field.components == 9 ? "Tensor" : "Matrix";
      const std::string where = file + (field.on_cells ? ":/VTKHDF/CellData/" : ":/VTKHDF/PointData/") + field.name;
      text += "<Attribute Name=\"" + field.name + "\" AttributeType=\"" + type + "\" Center=\"" + (field.on_cells ? "Cell" : "Node") + "\">";
      if (field.constant) {
        text += "<DataItem Dimensions=\"" + std::to_string(n) + "\" NumberType=\"Int\" Precision=\"4\" Format=\"HDF\">" + where + "</DataItem>";
      } else {
        text += slab(where, f * n, n, frames * n, field.components, d.precision);
      }
      text += "</Attribute>\n";
    }
    text += "</Grid>\n";
  }
  return text + "</Grid></Domain></Xdmf>\n";
}

}  // namespace mortise::output
