#include "render/module/painter.h"

#include <algorithm>
#include <cstring>

#include "render/module/shaders.h"

namespace mortise::render::module {

Painter::Programs::Programs()
    : depth(kMeshVertex, kDepthFragment),
      normal(kMeshVertex, kNormalFragment),
      occlusion(kScreenVertex, kOcclusionFragment),
      blur(kScreenVertex, kBlurFragment),
      screen(kScreenVertex, std::string(kBackground) + kScreenFragment),
      surface(kMeshVertex, std::string(kBackground) + "#define PLANE 0" + kSurfaceFragment),
      plane(kMeshVertex, std::string(kBackground) + "#define PLANE 1" + kSurfaceFragment),
      fisheye(kScreenVertex, kFisheyeFragment),
      measure(kMeshVertex, kMeasureFragment),
      measure_fisheye(kScreenVertex, kMeasureFisheyeFragment) {}

Painter::Painter() : surface_(16 * 16 * 4) {
  const int attributes[] = {
      OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0};
  context_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context_ == nullptr) throw std::runtime_error("OSMesa cannot create an OpenGL 3.3 core context");
  current();
  programs_ = std::make_unique<Programs>();
  shadow_.create();
  colour_map_ = new_texture(GL_TEXTURE_2D, GL_LINEAR, GL_CLAMP_TO_EDGE);
  glGenVertexArrays(1, &empty_);
}

Painter::~Painter() {
  programs_.reset();
  if (context_ != nullptr) OSMesaDestroyContext(context_);
}

void Painter::current() {
  if (OSMesaMakeCurrent(context_, surface_.data(), GL_UNSIGNED_BYTE, 16, 16) == GL_FALSE) throw std::runtime_error("OSMesa cannot use its context");
}

int Painter::add_texture(const std::uint8_t* rgba, int width, int height) {
  current();
  const GLuint id = new_texture(GL_TEXTURE_2D, GL_LINEAR, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
  glGenerateMipmap(GL_TEXTURE_2D);
  textures_.push_back(id);
  return static_cast<int>(textures_.size());
}

void Painter::draw(const MortiseRenderJob& job, std::uint8_t* rgb) {
  current();
  upload(job);
  lights(job);
  draw_shadow(job);
  const View view = front_view(job);
  picture_.resize(job.width, job.height);
  if (job.camera.fisheye != 0)
    draw_fisheye(job, view);
  else
    draw_view(job, view, picture_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.resolved);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const std::size_t row = static_cast<std::size_t>(job.width) * 3, rows = static_cast<std::size_t>(job.height);
  std::vector<std::uint8_t> bottom_up(row * rows);
  glReadPixels(0, 0, job.width, job.height, GL_RGB, GL_UNSIGNED_BYTE, bottom_up.data());
  for (std::size_t y = 0; y < rows; ++y) std::memcpy(rgb + y * row, bottom_up.data() + (rows - 1 - y) * row, row);
  free_geometry();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) throw std::runtime_error("OpenGL error " + std::to_string(error));
}

// The whole picture of a pinhole camera, or where a fisheye looks.
Painter::View Painter::front_view(const MortiseRenderJob& job) const {
  const MortiseRenderCamera& c = job.camera;
  View view{vec(c.position), cross(vec(c.forward), vec(c.up)), vec(c.up), vec(c.forward), 1, 1};
  if (c.fisheye != 0) return view;
  view.tan_y = std::tan(0.5f * c.fov);
  view.tan_x = view.tan_y * static_cast<float>(job.width) / static_cast<float>(job.height);
  return view;
}

M4 Painter::projection(const MortiseRenderJob& job, const View& view) {
  const float distance = std::sqrt(dot(vec(job.centre) - view.eye, vec(job.centre) - view.eye));
  const float near = std::max(0.002f * (distance + job.radius), 0.2f * (distance - job.radius)), far = distance + 12 * job.radius;
  return perspective(view.tan_x, view.tan_y, near, far);
}

void Painter::draw_shadow(const MortiseRenderJob& job) {
  glBindFramebuffer(GL_FRAMEBUFFER, shadow_.frame);
  glViewport(0, 0, kShadowSize, kShadowSize);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.5f, 4.0f);
  programs_->depth.use();
  programs_->depth.set("view_projection", light_);
  draw_meshes(job, nullptr);
  glDisable(GL_POLYGON_OFFSET_FILL);
}

void Painter::background_uniforms(const MortiseRenderJob& job, const View& view, const Program& p, const Target& target) {
  p.set("eye", view.eye);
  p.set("eye_up", vec(job.camera.up));
  p.set("background_top", vec(job.background_top));
  p.set("background_bottom", vec(job.background_bottom));
  p.set("fisheye", job.camera.fisheye);
  p.set("image", static_cast<float>(target.width), static_cast<float>(target.height));
}

void Painter::draw_view(const MortiseRenderJob& job, const View& view, Target& target) {
  const M4 look = view_matrix(view.eye, view.right, view.up, view.forward);
  const M4 project = projection(job, view) * look;
  glViewport(0, 0, target.width, target.height);
  const float reach = 0.12f * job.radius;

  glBindFramebuffer(GL_FRAMEBUFFER, target.geometry);
  glEnable(GL_DEPTH_TEST);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  programs_->normal.use();
  programs_->normal.set("view", look);
  programs_->normal.set("view_projection", project);
  draw_meshes(job, nullptr);
  draw_planes(job, nullptr);

  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(empty_);
  bind(0, GL_TEXTURE_2D, target.normal_depth);
  glBindFramebuffer(GL_FRAMEBUFFER, target.occlude);
  programs_->occlusion.use();
  programs_->occlusion.set("normal_depth", 0);
  programs_->occlusion.set("tangent", view.tan_x, view.tan_y);
  programs_->occlusion.set("reach", reach);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  bind(1, GL_TEXTURE_2D, target.occlusion);
  glBindFramebuffer(GL_FRAMEBUFFER, target.blur);
  programs_->blur.use();
  programs_->blur.set("normal_depth", 0);
  programs_->blur.set("occlusion", 1);
  programs_->blur.set("reach", reach);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glBindFramebuffer(GL_FRAMEBUFFER, target.multisampled);
  glClear(GL_DEPTH_BUFFER_BIT);
  const Program& screen = programs_->screen;
  screen.use();
  background_uniforms(job, view, screen, target);
  screen.set("axis_x", view.right);
  screen.set("axis_y", view.up);
  screen.set("axis_z", view.forward);
  screen.set("tangent", view.tan_x, view.tan_y);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glEnable(GL_DEPTH_TEST);
  bind(1, GL_TEXTURE_2D, target.blurred);
  bind(2, GL_TEXTURE_2D, shadow_.texture);
  bind(3, GL_TEXTURE_2D, colour_map_);
  for (const Program* s : {&programs_->surface, &programs_->plane}) {
    s->use();
    background_uniforms(job, view, *s, target);
    s->set("view_projection", project);
    s->set("up", vec(job.world_up));
    s->set("key_direction", key_);
    s->set("fill_direction", fill_);
    s->set("rim_direction", rim_);
    s->set("centre", vec(job.centre));
    s->set("radius", job.radius);
    s->set("light", light_);
    s->set("shadow_step", 1.7f / kShadowSize);
    s->set("scalar_low", job.scalar_low);
    s->set("scalar_high", job.scalar_high);
    s->set("base", 0);
    s->set("occlusion", 1);
    s->set("shadow", 2);
    s->set("colour_map", 3);
    if (s == &programs_->surface)
      draw_meshes(job, s);
    else
      draw_planes(job, s);
  }

  glBindFramebuffer(GL_READ_FRAMEBUFFER, target.multisampled);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.resolved);
  glBlitFramebuffer(0, 0, target.width, target.height, 0, 0, target.width, target.height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

// A face has at its centre size / (2 reach) pixels per radian; the picture has side / fov.
int Painter::face_size(const MortiseRenderJob& job) const {
  const float side = static_cast<float>(std::min(job.width, job.height));
  return std::clamp(static_cast<int>(std::ceil(2.2f * kReach * side / job.camera.fov)), 64, 2048);
}

// Order and orientation as in kFisheyeFragment.
std::array<Painter::View, 6> Painter::faces_of(const View& front) const {
  const V3 r = front.right, u = front.up, f = front.forward, b = -1.0f * f;
  return {{{front.eye, r, u, f, kReach, kReach},
           {front.eye, b, u, r, kReach, kReach},
           {front.eye, f, u, -1.0f * r, kReach, kReach},
           {front.eye, r, b, u, kReach, kReach},
           {front.eye, r, f, -1.0f * u, kReach, kReach},
           {front.eye, -1.0f * r, u, b, kReach, kReach}}};
}

void Painter::look_through_faces(const MortiseRenderJob& job, const View& front, FaceStore& faces, GLuint face_frame, GLuint frame, const Program& p,
                                 const std::function<void(const View&)>& draw) {
  const int size = face_size(job);
  faces.bind_resized(size);
  const std::array<View, 6> views = faces_of(front);
  for (int k = 0; k < 6; ++k) {
    if (k == 5 && job.camera.fov < kSeesBack) continue;
    draw(views[static_cast<std::size_t>(k)]);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, face_frame);
    glActiveTexture(GL_TEXTURE4);
    glCopyTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, k, 0, 0, size, size);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glViewport(0, 0, job.width, job.height);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(empty_);
  p.use();
  p.set("faces", 4);
  p.set("image", static_cast<float>(job.width), static_cast<float>(job.height));
  p.set("fov", job.camera.fov);
  p.set("reach", kReach);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Painter::draw_fisheye(const MortiseRenderJob& job, const View& front) {
  face_.resize(face_size(job), face_size(job));
  look_through_faces(job, front, faces_, face_.resolved, picture_.resolved, programs_->fisheye,
                     [&](const View& view) { draw_view(job, view, face_); });
}

}  // namespace mortise::render::module
