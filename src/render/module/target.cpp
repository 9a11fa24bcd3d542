#include "render/module/target.h"

namespace mortise::render::module {
namespace {

GLuint image_texture(GLint format, GLenum layout, GLenum type, int w, int h) {
  const GLuint id = new_texture(GL_TEXTURE_2D, GL_NEAREST, GL_CLAMP_TO_EDGE);
  glTexImage2D(GL_TEXTURE_2D, 0, format, w, h, 0, layout, type, nullptr);
  return id;
}

GLuint frame_of(GLuint texture, const char* name) {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  if (name != nullptr) check_frame(name);
  return id;
}

void attach_buffer(GLuint buffer, int samples, GLenum format, GLenum point, int w, int h) {
  glBindRenderbuffer(GL_RENDERBUFFER, buffer);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, w, h);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, point, GL_RENDERBUFFER, buffer);
}

}  // namespace

void check_frame(const char* name) {
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(std::string("OSMesa cannot draw into the ") + name + " image");
}

void FaceStore::bind_resized(int texels) {
  if (texture == 0) texture = new_texture(GL_TEXTURE_2D_ARRAY, filter, GL_CLAMP_TO_EDGE);
  bind(4, GL_TEXTURE_2D_ARRAY, texture);
  if (size == texels) return;
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, stored, texels, texels, 6, 0, format, type, nullptr);
  size = texels;
}

void Target::resize(int w, int h) {
  if (w == width && h == height) return;
  release();
  width = w, height = h;
  normal_depth = image_texture(GL_RGBA32F, GL_RGBA, GL_FLOAT, w, h);
  occlusion = image_texture(GL_R8, GL_RED, GL_UNSIGNED_BYTE, w, h);
  blurred = image_texture(GL_R8, GL_RED, GL_UNSIGNED_BYTE, w, h);
  glGenRenderbuffers(4, buffers);
  geometry = frame_of(normal_depth, nullptr);
  attach_buffer(buffers[0], 0, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, w, h);
  check_frame("geometry");
  occlude = frame_of(occlusion, "occlusion");
  blur = frame_of(blurred, "occlusion");
  glGenFramebuffers(1, &multisampled);
  glBindFramebuffer(GL_FRAMEBUFFER, multisampled);
  attach_buffer(buffers[1], kSamples, GL_RGBA8, GL_COLOR_ATTACHMENT0, w, h);
  attach_buffer(buffers[2], kSamples, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, w, h);
  check_frame("multisampled");
  glGenFramebuffers(1, &resolved);
  glBindFramebuffer(GL_FRAMEBUFFER, resolved);
  attach_buffer(buffers[3], 0, GL_RGBA8, GL_COLOR_ATTACHMENT0, w, h);
  check_frame("resolved");
}

void Target::release() {
  if (width == 0) return;
  const GLuint textures[] = {normal_depth, occlusion, blurred}, frames[] = {geometry, occlude, blur, multisampled, resolved};
  glDeleteTextures(3, textures);
  glDeleteFramebuffers(5, frames);
  glDeleteRenderbuffers(4, buffers);
  width = height = 0;
}

void MeasureTarget::resize(int w, int h) {
  if (w == width && h == height) return;
  if (width != 0) {
    glDeleteTextures(1, &values);
    glDeleteFramebuffers(1, &frame);
    glDeleteRenderbuffers(1, &buffer);
  }
  width = w, height = h;
  values = image_texture(GL_RG32F, GL_RG, GL_FLOAT, w, h);
  frame = frame_of(values, nullptr);
  glGenRenderbuffers(1, &buffer);
  attach_buffer(buffer, 0, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT, w, h);
  check_frame("distance");
}

void Shadow::create() {
  texture = new_texture(GL_TEXTURE_2D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, kShadowSize, kShadowSize, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  check_frame("shadow");
}

}  // namespace mortise::render::module
