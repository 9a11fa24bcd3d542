#pragma once
// OSMesa exports every entry point of the core profile, so no loader is needed.
#include <GL/glcorearb.h>
#include <GL/osmesa.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace mortise::render::module {

using V3 = std::array<float, 3>;
using M4 = std::array<float, 16>;  // column-major

inline V3 operator+(V3 a, V3 b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline V3 operator-(V3 a, V3 b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline V3 operator*(float s, V3 a) { return {s * a[0], s * a[1], s * a[2]}; }
inline float dot(V3 a, V3 b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline V3 cross(V3 a, V3 b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
inline V3 unit(V3 a) { return (1.0f / std::sqrt(dot(a, a))) * a; }
inline V3 vec(const float* p) { return {p[0], p[1], p[2]}; }
inline V3 perpendicular(V3 a) { return unit(cross(a, std::abs(a[0]) < 0.7f ? V3{1, 0, 0} : V3{0, 1, 0})); }

inline M4 operator*(const M4& a, const M4& b) {
  M4 c{};
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 4; ++k) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
  return c;
}
// Right-handed view: -z looks along `forward`.
inline M4 view_matrix(V3 eye, V3 right, V3 up, V3 forward) {
  return {right[0], up[0], -forward[0], 0, right[1],         up[1],         -forward[1],       0,
          right[2], up[2], -forward[2], 0, -dot(right, eye), -dot(up, eye), dot(forward, eye), 1};
}
inline M4 perspective(float tan_x, float tan_y, float near, float far) {
  return {1 / tan_x, 0, 0, 0, 0, 1 / tan_y, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0};
}
inline M4 orthographic(float half, float near, float far) {
  return {1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1};
}

// A linked program; uniforms by name.
class Program {
 public:
  Program(const std::string& vertex, const std::string& fragment);
  void use() const { glUseProgram(id_); }
  void set(const char* name, float v) const { glUniform1f(at(name), v); }
  void set(const char* name, int v) const { glUniform1i(at(name), v); }
  void set(const char* name, float x, float y) const { glUniform2f(at(name), x, y); }
  void set(const char* name, V3 v) const { glUniform3f(at(name), v[0], v[1], v[2]); }
  void set(const char* name, const M4& m) const { glUniformMatrix4fv(at(name), 1, GL_FALSE, m.data()); }

 private:
  GLint at(const char* name) const { return glGetUniformLocation(id_, name); }
  GLuint id_ = 0;
};

inline GLuint new_texture(GLenum target, GLenum filter, GLenum wrap) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(target, id);
  glTexParameteri(target, GL_TEXTURE_MIN_FILTER, static_cast<GLint>(filter));
  glTexParameteri(target, GL_TEXTURE_MAG_FILTER, static_cast<GLint>(filter));
  glTexParameteri(target, GL_TEXTURE_WRAP_S, static_cast<GLint>(wrap));
  glTexParameteri(target, GL_TEXTURE_WRAP_T, static_cast<GLint>(wrap));
  return id;
}
inline void bind(int unit, GLenum target, GLuint texture) {
  glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  glBindTexture(target, texture);
}

}  // namespace mortise::render::module
