#pragma once
// What geoms are made of: meshes and materials of <asset>, and the shapes that geoms themselves are.
#include <map>

#include "importers/mjcf/compiler.h"
#include "importers/mjcf/defaults.h"

namespace mortise::importers::mjcf {

class Assets {
 public:
  Assets(const Compiler& compiler, const Defaults& defaults, Notes& notes) : compiler_(compiler), defaults_(defaults), notes_(notes) {}
  void read(const Element& asset);
  // A completed <geom> in the frame `at`; nothing where it is of a kind that is left out.
  std::optional<Shape> shape(const Element& geom, const Pose& at) const;

 private:
  struct Mesh {
    std::string file;
    Vec3 scale = Vec3::Ones();
    Pose at;  // of the file's coordinates in the geom
  };
  void mesh(const Element& e);
  void fill(const Element& geom, const std::string& type, Shape& out) const;
  void between(const Element& geom, Shape& out, Vec3& half) const;
  void of_mesh(const Element& geom, Shape& out) const;

  const Compiler& compiler_;
  const Defaults& defaults_;
  Notes& notes_;
  std::map<std::string, Mesh> meshes_;
  std::map<std::string, Vec3> colours_;
  std::map<std::string, std::string> textures_, painted_;  // files by texture; by material
};

}  // namespace mortise::importers::mjcf
