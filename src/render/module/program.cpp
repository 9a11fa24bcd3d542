#include "render/module/gl.h"

namespace mortise::render::module {
namespace {

GLuint compile(GLenum kind, const std::string& source) {
  const GLuint id = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(id, 1, &text, nullptr);
  glCompileShader(id);
  GLint ok = 0;
  glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
  if (ok == 0) {
    char log[2048] = "";
    glGetShaderInfoLog(id, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("shader: ") + log);
  }
  return id;
}

}  // namespace

Program::Program(const std::string& vertex, const std::string& fragment) : id_(glCreateProgram()) {
  const GLuint v = compile(GL_VERTEX_SHADER, vertex), f = compile(GL_FRAGMENT_SHADER, fragment);
  glAttachShader(id_, v);
  glAttachShader(id_, f);
  glLinkProgram(id_);
  glDeleteShader(v);
  glDeleteShader(f);
  GLint ok = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &ok);
  if (ok == 0) {
    char log[2048] = "";
    glGetProgramInfoLog(id_, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("shader program: ") + log);
  }
}

}  // namespace mortise::render::module
