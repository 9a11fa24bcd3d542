#pragma once

namespace mortise::model {

class Model;

// Lays out degrees of freedom, points, mesh, mass and surface of all bodies of model.input.
void build(Model& model);

}  // namespace mortise::model
