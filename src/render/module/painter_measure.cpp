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
  measured_face_.resize(face_size(job), face_size(job));
  look_through_faces(job, front, measured_faces_, measured_face_.frame, measured_.frame, programs_->measure_fisheye,
                     [&](const View& view) { measure_view(job, view, measured_face_); });
}

}  // namespace mortise::render::module
