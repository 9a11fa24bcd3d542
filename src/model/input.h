#pragma once
// Plain data that crosses from the front end (scene, meshes) to the engine, on whichever device it runs.
#include <array>
#include <string>
#include <vector>

#include "base/params.h"
#include "geometry/mesh.h"

namespace mortise::model {

enum class BodyType : int { soft = 0, stiff = 1, half_space = 2 };
enum class MaterialModel : std::uint8_t { linear = 0, corotated = 1, neo_hookean = 2 };

// A body with its mesh in world coordinates at t = 0 [m].
struct BodyInput {
  std::string name;
  BodyType type = BodyType::soft;
  int env = 0;
  std::vector<Vec3> nodes;                     // soft: all nodes; stiff: surface vertices
  std::vector<Tet> tets;                       // soft only, positively oriented: corners
  std::vector<Triangle> triangles;             // surface, outward; of quadratic tetrahedra: the quarters of `faces`, four each
  std::vector<geometry::Midsides> midsides{};  // quadratic tetrahedra only: one per tetrahedron
  std::vector<geometry::Face> faces{};         // and their surface
  Params params;                               // the body's block of the scene
  Params material;                             // its material block (youngs_modulus, poisson_ratio, density, model)
};

// Gives a soft body this mesh, placed as it is.
void set_mesh(BodyInput& body, geometry::TetMesh mesh);

struct ModelInput {
  Params scene;  // the whole resolved scene; of several environments that of the first
  std::vector<BodyInput> bodies;
  std::vector<Params> scenes{};  // of several environments that of each, where they are not all the same

  // The block of an effect in the scene of an environment; `first`: that in `scene`.
  const Params& effect_of(const Params& first, int env) const {
    if (!scenes.empty())
      for (const auto& [name, block] : scene.at("effects").entries())
        if (&block == &first) return scenes[static_cast<std::size_t>(env)].at("effects").at(name);
    return first;
  }
};

}  // namespace mortise::model
