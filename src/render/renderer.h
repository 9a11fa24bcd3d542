#pragma once
#include <memory>

#include "render/job.h"

namespace mortise::render {

// Draws pictures without a display. The first one loads the drawing module, libmortise_render.so, looked for beside the
// program, in ../lib of it, and where it was built. Not for two threads at once; several renderers may work side by side.
// Equal jobs give equal bits.
// Throws Error(Exit::scene) for a camera that sees nothing by construction.
void check_job(const RenderJob& job);

class Renderer {
 public:
  Renderer();  // throws Error(Exit::device) where the module is absent or does not fit
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  // Throws as check_job() does, and Error(Exit::device) when drawing fails.
  Image draw(const RenderJob& job);

  // What the middle of each pixel sees: which body, and how far. Throws as draw() does.
  Measurement measure(const RenderJob& job);

 private:
  struct Module;
  std::unique_ptr<Module> module_;
};

}  // namespace mortise::render
