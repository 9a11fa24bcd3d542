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

struct Shadow {
  GLuint texture = 0, frame = 0;
  void create();
};

// Throws when the bound framebuffer cannot be drawn into.
void check_frame(const char* name);

}  // namespace mortise::render::module
