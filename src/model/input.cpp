#include "model/input.h"

#include <utility>

#include "geometry/midsides.h"
#include "geometry/topology.h"

namespace mortise::model {

void set_mesh(BodyInput& body, geometry::TetMesh mesh) {
  body.faces = mesh.quadratic() ? geometry::boundary_faces(mesh) : std::vector<geometry::Face>{};
  body.triangles = mesh.quadratic() ? geometry::quarters(body.faces) : geometry::boundary_triangles(mesh);
  body.nodes = std::move(mesh.points);
  body.tets = std::move(mesh.tets);
  body.midsides = std::move(mesh.midsides);
}

}  // namespace mortise::model
