// Geometry on the device, and the lights that depend on it.
#include "render/module/painter.h"

namespace mortise::render::module {
namespace {

void attribute(GLuint buffer, GLuint location, int components, int vertices, const float* data) {
  if (data == nullptr) {
    const float zero[4] = {};
    glVertexAttrib4fv(location, zero);
    return;
  }
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(sizeof(float)) * components * vertices, data, GL_STREAM_DRAW);
  glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, 0, nullptr);
  glEnableVertexAttribArray(location);
}

// Level, where the plane is a slope and z points upwards.
V3 along(V3 normal) { return std::abs(normal[2]) < 0.999f ? unit(cross({0, 0, 1}, normal)) : perpendicular(normal); }

}  // namespace

void Painter::upload(const MortiseRenderJob& job) {
  bind(0, GL_TEXTURE_2D, colour_map_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, 256, 1, 0, GL_RGB, GL_UNSIGNED_BYTE, job.colour_map);
  for (int i = 0; i < job.meshes; ++i) {
    const MortiseRenderMesh& m = job.mesh[i];
    Geometry& g = meshes_.emplace_back();
    glGenVertexArrays(1, &g.array);
    glBindVertexArray(g.array);
    glGenBuffers(5, g.buffers);
    attribute(g.buffers[0], 0, 3, m.vertices, m.positions);
    attribute(g.buffers[1], 1, 3, m.vertices, m.normals);
    attribute(g.buffers[2], 2, 2, m.vertices, m.uvs);
    attribute(g.buffers[3], 3, 1, m.vertices, m.scalars);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, g.buffers[4]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(sizeof(std::int32_t)) * 3 * m.triangles, m.corners, GL_STREAM_DRAW);
  }
  for (int i = 0; i < job.planes; ++i) {
    const MortiseRenderPlane& plane = job.plane[i];
    const V3 n = vec(plane.normal), u = along(n), v = cross(n, u), c = vec(job.centre);
    const V3 foot = c - dot(c - vec(plane.point), n) * n;  // the part of the plane nearest to the scene
    // Divided, so that interpolated positions stay accurate next to the camera.
    constexpr int cells = 16;
    const float half = 9 * job.radius;
    std::vector<V3> positions, normals;
    std::vector<std::int32_t> corners;
    for (int y = 0; y <= cells; ++y)
      for (int x = 0; x <= cells; ++x) {
        const float a = half * (2.0f * static_cast<float>(x) / cells - 1), b = half * (2.0f * static_cast<float>(y) / cells - 1);
        positions.push_back(foot + a * u + b * v);
        normals.push_back(n);
      }
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        const int k = y * (cells + 1) + x;
        corners.insert(corners.end(), {k, k + 1, k + cells + 2, k, k + cells + 2, k + cells + 1});
      }
    Geometry& g = planes_.emplace_back();
    plane_axes_.push_back({u, v});
    glGenVertexArrays(1, &g.array);
    glBindVertexArray(g.array);
    glGenBuffers(5, g.buffers);
    attribute(g.buffers[0], 0, 3, static_cast<int>(positions.size()), positions[0].data());
    attribute(g.buffers[1], 1, 3, static_cast<int>(normals.size()), normals[0].data());
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, g.buffers[4]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(sizeof(std::int32_t) * corners.size()), corners.data(), GL_STREAM_DRAW);
  }
}

void Painter::free_geometry() {
  for (std::vector<Geometry>* list : {&meshes_, &planes_}) {
    for (Geometry& g : *list) {
      glDeleteVertexArrays(1, &g.array);
      glDeleteBuffers(5, g.buffers);
    }
    list->clear();
  }
  plane_axes_.clear();
}

// Key light from above the left shoulder of the camera, fill from the right, rim from behind.
void Painter::lights(const MortiseRenderJob& job) {
  const V3 forward = vec(job.camera.forward), right = cross(forward, vec(job.camera.up)), up = vec(job.world_up);
  key_ = unit(1.15f * up - 0.75f * right - 0.45f * forward);
  fill_ = unit(0.35f * up + 1.0f * right - 0.5f * forward);
  rim_ = unit(0.55f * up + 0.35f * right + 1.0f * forward);
  const float r = job.radius;
  const V3 side = perpendicular(key_), eye = vec(job.centre) + (3 * r) * key_;
  light_ = orthographic(1.02f * r, 1.5f * r, 9.0f * r) * view_matrix(eye, side, cross(key_, side), -1.0f * key_);
}

void Painter::draw_meshes(const MortiseRenderJob& job, const Program* material) {
  for (int i = 0; i < job.meshes; ++i) {
    const MortiseRenderMesh& m = job.mesh[i];
    glBindVertexArray(meshes_[static_cast<std::size_t>(i)].array);
    if (material == nullptr) {
      glDrawElements(GL_TRIANGLES, 3 * m.triangles, GL_UNSIGNED_INT, nullptr);
      continue;
    }
    material->set("has_scalar", m.scalars != nullptr ? 1 : 0);
    for (int k = 0; k < m.parts; ++k) {
      const MortiseRenderPart& part = m.part[k];
      material->set("colour_factor", vec(part.colour));
      material->set("roughness", part.roughness);
      material->set("metallic", part.metallic);
      material->set("has_texture", part.texture > 0 ? 1 : 0);
      bind(0, GL_TEXTURE_2D, part.texture > 0 ? textures_.at(static_cast<std::size_t>(part.texture - 1)) : colour_map_);
      const std::size_t offset = sizeof(std::int32_t) * 3 * static_cast<std::size_t>(part.first_triangle);
      glDrawElements(GL_TRIANGLES, 3 * part.triangles, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset));
    }
  }
}

void Painter::draw_planes(const MortiseRenderJob& job, const Program* material) {
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    if (material != nullptr) {
      material->set("colour_factor", vec(job.plane[i].colour));
      material->set("checker", job.plane[i].checker);
      material->set("plane_point", vec(job.plane[i].point));
      material->set("plane_u", plane_axes_[i][0]);
      material->set("plane_v", plane_axes_[i][1]);
    }
    glBindVertexArray(planes_[i].array);
    glDrawElements(GL_TRIANGLES, 16 * 16 * 6, GL_UNSIGNED_INT, nullptr);
  }
}

}  // namespace mortise::render::module
