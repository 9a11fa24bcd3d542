#pragma once
// The images that the passes draw into, for one picture size.
#include "render/module/gl.h"

namespace mortise::render::module {

constexpr int kSamples = 4;
constexpr int kShadowSize = 2048;

struct Target {
  int width = 0, height = 0;
  GLuint normal_depth = 0, occlusion = 0, blurred = 0;  // textures
  GLuint geometry = 0, occlude = 0, blur = 0;           // framebuffers of these
  GLuint multisampled = 0, resolved = 0;                // framebuffers of the picture
  GLuint buffers[4] = {};

  void resize(int w, int h);
  void release();
};

// Which mesh and how far, per pixel: one sample in the middle of each.
struct MeasureTarget {
  int width = 0, height = 0;
  GLuint values = 0, frame = 0, buffer = 0;
  void resize(int w, int h);
};

// The six faces that a fisheye looks through, as layers of a texture.
struct FaceStore {
  GLenum filter;
  GLint stored;
  GLenum format, type;
  GLuint texture = 0;
  int size = 0;
  void bind_resized(int texels);  // to unit 4
};

// Cameras that are fisheyes look through the faces of a cube, a little wider than these [tan of half the opening].
constexpr float kReach = 1.02f;
// [rad] wider fields of view see the face behind: cube corners lie 125 degrees off the axis
constexpr float kSeesBack = 4.3f;

struct Shadow {
  GLuint texture = 0, frame = 0;
  void create();
};

// Throws when the bound framebuffer cannot be drawn into.
void check_frame(const char* name);

}  // namespace mortise::render::module
