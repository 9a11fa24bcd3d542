#include "run/output_mesh.h"

#include <algorithm>

namespace mortise::run {

output::OutputMesh output_mesh(const model::ModelInput& input) {
  output::OutputMesh mesh;
  mesh.offsets.push_back(0);
  for (const model::BodyInput& body : input.bodies) {
    if (body.type == model::BodyType::half_space) continue;
    const auto first = static_cast<std::int64_t>(mesh.points.size());
    const int id = static_cast<int>(mesh.body_names.size());
    mesh.body_names.push_back(body.name);
    mesh.points.insert(mesh.points.end(), body.nodes.begin(), body.nodes.end());
    mesh.body_of_point.resize(mesh.points.size(), id);
    const auto cell = [&](const Index* v, int n, std::uint8_t type) {
      for (int k = 0; k < n; ++k) mesh.connectivity.push_back(first + v[k]);
      mesh.offsets.push_back(static_cast<std::int64_t>(mesh.connectivity.size()));
      mesh.types.push_back(type);
      mesh.body_of_cell.push_back(id);
    };
    for (std::size_t t = 0; t < body.tets.size(); ++t) {
      if (body.midsides.empty()) {
        cell(body.tets[t].v, 4, output::tetrahedron);
        continue;
      }
      Index nodes[10];  // in the order of VTK
      std::copy_n(body.tets[t].v, 4, nodes), std::copy_n(body.midsides[t].v, 6, nodes + 4);
      cell(nodes, 10, output::quadratic_tetrahedron);
    }
    if (body.type == model::BodyType::stiff)
      for (const Triangle& t : body.triangles) cell(t.v, 3, output::triangle);
  }
  return mesh;
}

}  // namespace mortise::run
