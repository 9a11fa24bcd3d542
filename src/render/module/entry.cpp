// The exported function table: exceptions end here.
#include <cstdio>

#include "render/module/painter.h"

struct MortiseRenderContext {
  mortise::render::module::Painter painter;
};

namespace {

MortiseRenderContext* create(char* message, std::int32_t capacity) {
  try {
    return new MortiseRenderContext;
  } catch (const std::exception& e) {
    std::snprintf(message, static_cast<std::size_t>(capacity), "%s", e.what());
    return nullptr;
  }
}

void destroy(MortiseRenderContext* c) { delete c; }

std::int32_t add_texture(MortiseRenderContext* c, const std::uint8_t* rgba, std::int32_t width, std::int32_t height) {
  try {
    return c->painter.add_texture(rgba, width, height);
  } catch (const std::exception&) {
    return 0;
  }
}

std::int32_t draw(MortiseRenderContext* c, const MortiseRenderJob* job, std::uint8_t* rgb, char* message, std::int32_t capacity) {
  try {
    c->painter.draw(*job, rgb);
    return 0;
  } catch (const std::exception& e) {
    std::snprintf(message, static_cast<std::size_t>(capacity), "%s", e.what());
    return 1;
  }
}

std::int32_t measure(MortiseRenderContext* c, const MortiseRenderJob* job, std::int32_t* mesh, float* distance, char* message,
                     std::int32_t capacity) {
  try {
    c->painter.measure(*job, mesh, distance);
    return 0;
  } catch (const std::exception& e) {
    std::snprintf(message, static_cast<std::size_t>(capacity), "%s", e.what());
    return 1;
  }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const MortiseRenderApi* mortise_render_api() {
  static const MortiseRenderApi api{MORTISE_RENDER_API, create, destroy, add_texture, draw, measure};
  return &api;
}
