// Which mesh each pixel sees, and how far it is.
#include <cmath>

#include "render/module/painter.h"

namespace mortise::render::module {

void Painter::measure(const MortiseRenderJob& job, std::int32_t* mesh, float* distance) {
  current();
  upload(job);
  const View view = front_view(job);
  measured_.resize(job.width, job.height);
  if (job.camera.fisheye != 0)
    measure_fisheye(job, view);
  else
    measure_view(job, view, measured_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, measured_.frame);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const std::size_t columns = static_cast<std::size_t>(job.width), rows = static_cast<std::size_t>(job.height);
  std::vector<float> bottom_up(2 * columns * rows);
  glReadPixels(0, 0, job.width, job.height, GL_RG, GL_FLOAT, bottom_up.data());
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const float* seen = bottom_up.data() + 2 * ((rows - 1 - y) * columns + x);
      mesh[y * columns + x] = static_cast<std::int32_t>(std::lround(seen[0])) - 1;
      distance[y * columns + x] = seen[1];
    }
  free_geometry();
  if (const GLenum error = glGetError(); error != GL_NO_ERROR) throw std::runtime_error("OpenGL error " + std::to_string(error));
}

void Painter::measure_view(const MortiseRenderJob& job, const View& view, const MeasureTarget& target) {
  const M4 look = view_matrix(view.eye, view.right, view.up, view.forward);
  glBindFramebuffer(GL_FRAMEBUFFER, target.frame);
  glViewport(0, 0, target.width, target.height);
  glEnable(GL_DEPTH_TEST);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Program& p = programs_->measure;
  p.use();
  p.set("view", look);
  p.set("view_projection", projection(job, view) * look);
  for (int i = 0; i < job.meshes; ++i) {
    p.set("mesh", static_cast<float>(i + 1));
    glBindVertexArray(meshes_[static_cast<std::size_t>(i)].array);
    glDrawElements(GL_TRIANGLES, 3 * job.mesh[i].triangles, GL_UNSIGNED_INT, nullptr);
  }
}

void Painter::measure_fisheye(const MortiseRenderJob& job, const View& front) {
  const int size = face_size(job);
  measured_face_.resize(size, size);
  if (measured_faces_ == 0) measured_faces_ = new_texture(GL_TEXTURE_2D_ARRAY, GL_NEAREST, GL_CLAMP_TO_EDGE);
  bind(4, GL_TEXTURE_2D_ARRAY, measured_faces_);
  if (measured_faces_size_ != size) {
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RG32F, size, size, 6, 0, GL_RG, GL_FLOAT, nullptr);
    measured_faces_size_ = size;
  }
  const std::array<View, 6> views = faces_of(front);
  for (int k = 0; k < 6; ++k) {
    if (k == 5 && job.camera.fov < kSeesBack) continue;
    measure_view(job, views[static_cast<std::size_t>(k)], measured_face_);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, measured_face_.frame);
    glActiveTexture(GL_TEXTURE4);
    glCopyTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, k, 0, 0, size, size);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, measured_.frame);
  glViewport(0, 0, job.width, job.height);
  glDisable(GL_DEPTH_TEST);
  glBindVertexArray(empty_);
  const Program& p = programs_->measure_fisheye;
  p.use();
  p.set("faces", 4);
  p.set("image", static_cast<float>(job.width), static_cast<float>(job.height));
  p.set("fov", job.camera.fov);
  p.set("reach", kReach);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace mortise::render::module
