#pragma once
// What one picture shows. Lengths in metres, colours sRGB in 0..1 unless said otherwise.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/types.h"
#include "render/image.h"

namespace mortise::render {

struct Camera {
  enum class Model { pinhole, fisheye };  // fisheye: equidistant, r = f theta
  Model model = Model::pinhole;
  Vec3 position{0, -1, 0.5};
  Vec3 look_at{0, 0, 0};
  Vec3 up{0, 0, 1};  // where up is in the world; need not be orthogonal to the line of sight
  double fov = 0.6;  // [rad]; pinhole: over the height; fisheye: over the shorter side, at most 2 pi
};

struct Material {
  Vec3 colour{0.8, 0.8, 0.8};  // linear RGB, multiplied with the texture
  double roughness = 0.5, metallic = 0;
  std::shared_ptr<const Texture> texture;
};

// A surface ready to draw: one normal and texture coordinate per point.
struct DrawMesh {
  std::vector<Vec3> points, normals;
  std::vector<Vec2> uvs;  // empty, or one per point; (0,0) is the lower left corner of the picture
  std::vector<Triangle> triangles;
  std::vector<Index> material;  // per triangle, into `materials`; empty: all zero
  std::vector<Material> materials{Material{}};
};

// A mesh in one picture. The mesh must live until the picture is drawn.
struct Drawn {
  const DrawMesh* mesh = nullptr;
  std::vector<double> scalar;  // empty, or one value per point: drawn in the colours of the colour bar
  int id = 0;                  // which body it is, above zero; 0: none that a measurement names
};

struct GroundPlane {
  Vec3 point{0, 0, 0}, normal{0, 0, 1};
  Vec3 colour{0.62, 0.62, 0.64};
  double checker = 0;  // edge of the squares [m], 0: plain
  int id = 0;          // as of Drawn
};

// Colours for the values in [low, high] (SI); shown in `unit` after multiplication with `scale`.
struct ColourBar {
  std::string label, unit;
  double low = 0, high = 1, scale = 1;
};

// In the world [m]; drawn over everything, so that bodies do not hide what acts between them.
struct Arrow {
  Vec3 from, to;
};

// First row on top. `distance` [m]: along the line of sight, the z of the camera (pinhole), or along the ray (fisheye); infinite where nothing is
// seen.
struct Measurement {
  int width = 0, height = 0;
  std::vector<int> id;           // of Drawn and GroundPlane; 0: nothing
  std::vector<double> distance;  // [m]
};

struct RenderJob {
  int width = 1280, height = 720;
  Camera camera;
  std::vector<Drawn> meshes;
  std::vector<GroundPlane> planes;
  std::vector<Arrow> arrows;
  std::optional<ColourBar> bar;  // needed where a mesh has scalars
  std::string caption;           // lower left corner
  bool annotated = true;         // else neither is drawn
  Vec3 background_top{0.93, 0.94, 0.96}, background_bottom{0.70, 0.73, 0.78};
};

}  // namespace mortise::render
