#pragma once
// The boundary between the program and the drawing module (libmortise_render.so): plain data only, so that neither C++
// runtime types nor exceptions cross it. Lengths in metres, already relative to an origin near the scene (floats do not
// carry a part of a micrometre far from zero). Colours are linear RGB unless marked sRGB.
#include <cstdint>

extern "C" {

constexpr int MORTISE_RENDER_API = 2;

// A run of triangles of one material. `texture` is a handle from add_texture, 0 = none.
struct MortiseRenderPart {
  std::int32_t first_triangle, triangles;
  float colour[3];
  float roughness, metallic;
  std::int32_t texture;
};

struct MortiseRenderMesh {
  std::int32_t vertices, triangles, parts;
  const float* positions;         // vertices x 3
  const float* normals;           // vertices x 3, unit
  const float* uvs;               // vertices x 2 or null; v points up, as in OBJ
  const float* scalars;           // vertices or null: coloured by the colour map
  const std::int32_t* corners;    // triangles x 3
  const MortiseRenderPart* part;  // parts
};

struct MortiseRenderPlane {
  float point[3], normal[3];
  float colour[3];
  float checker;  // edge of a square [m], 0 = plain
};

struct MortiseRenderCamera {
  std::int32_t fisheye;                  // 0: pinhole
  float position[3], forward[3], up[3];  // forward and up: unit, orthogonal
  float fov;                             // rad; pinhole: over the height; fisheye: over the shorter side
};

struct MortiseRenderJob {
  std::int32_t width, height, meshes, planes;
  const MortiseRenderMesh* mesh;
  const MortiseRenderPlane* plane;
  MortiseRenderCamera camera;
  float world_up[3];  // where the light comes from
  float background_top[3], background_bottom[3];
  float centre[3], radius;         // sphere around everything that throws a shadow
  const std::uint8_t* colour_map;  // 256 x 3, sRGB
  float scalar_low, scalar_high;
};

struct MortiseRenderContext;

struct MortiseRenderApi {
  std::int32_t version;
  // Null on failure; the reason is then in `message` (capacity bytes).
  MortiseRenderContext* (*create)(char* message, std::int32_t capacity);
  void (*destroy)(MortiseRenderContext*);
  // rgba: width x height x 4, sRGB, first row on top. Returns a handle > 0.
  std::int32_t (*add_texture)(MortiseRenderContext*, const std::uint8_t* rgba, std::int32_t width, std::int32_t height);
  // rgb: width x height x 3, sRGB, first row on top. 0 = done, otherwise the reason is in `message`.
  std::int32_t (*draw)(MortiseRenderContext*, const MortiseRenderJob*, std::uint8_t* rgb, char* message, std::int32_t capacity);
  // What the middle of each pixel sees of the meshes (planes are left to the caller, who knows them exactly), first row on top: index of the mesh or
  // -1, and how far it is [m], along the line of sight (pinhole) or along the ray (fisheye). As draw() otherwise.
  std::int32_t (*measure)(MortiseRenderContext*, const MortiseRenderJob*, std::int32_t* mesh, float* distance, char* message, std::int32_t capacity);
};

// The one exported symbol of the module.
using MortiseRenderEntry = const MortiseRenderApi* (*)();
}
