#include "run/output_mesh.h"

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
    if (body.type == model::BodyType::soft)
      for (const Tet& t : body.tets) cell(t.v, 4, output::tetrahedron);
    else
      for (const Triangle& t : body.triangles) cell(t.v, 3, output::triangle);
  }
  return mesh;
}

}  // namespace mortise::run
