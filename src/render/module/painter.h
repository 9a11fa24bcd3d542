#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "render/api.h"
#include "render/module/target.h"

namespace mortise::render::module {

// One OSMesa context with its programs; draws jobs. Not shared between threads at the same time.
class Painter {
 public:
  Painter();
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  int add_texture(const std::uint8_t* rgba, int width, int height);
  void draw(const MortiseRenderJob& job, std::uint8_t* rgb);
  void measure(const MortiseRenderJob& job, std::int32_t* mesh, float* distance);

 private:
  // One perspective view: the whole picture of a pinhole camera or a face of a fisheye.
  struct View {
    V3 eye, right, up, forward;
    float tan_x, tan_y;
  };
  struct Geometry {  // a mesh on the device
    GLuint array = 0, buffers[5] = {};
  };
  struct Programs {
    Program depth, normal, occlusion, blur, screen, surface, plane, fisheye, measure, measure_fisheye;
    Programs();
  };

  void current();
  void upload(const MortiseRenderJob& job);
  void free_geometry();
  View front_view(const MortiseRenderJob& job) const;
  static M4 projection(const MortiseRenderJob& job, const View& view);
  std::array<View, 6> faces_of(const View& front) const;  // of a fisheye: front, right, left, up, down, back
  int face_size(const MortiseRenderJob& job) const;
  // The picture of a fisheye in `frame`, by `program` from the six faces that draw() leaves in `face_frame` one after the other.
  void look_through_faces(const MortiseRenderJob& job, const View& front, FaceStore& faces, GLuint face_frame, GLuint frame, const Program& program,
                          const std::function<void(const View&)>& draw);
  void measure_view(const MortiseRenderJob& job, const View& view, const MeasureTarget& target);
  void measure_fisheye(const MortiseRenderJob& job, const View& front);
  void draw_shadow(const MortiseRenderJob& job);
  void draw_view(const MortiseRenderJob& job, const View& view, Target& target);
  void draw_fisheye(const MortiseRenderJob& job, const View& front);
  void draw_meshes(const MortiseRenderJob& job, const Program* material);
  void draw_planes(const MortiseRenderJob& job, const Program* material);
  void background_uniforms(const MortiseRenderJob& job, const View& view, const Program& program, const Target& target);
  void lights(const MortiseRenderJob& job);

  OSMesaContext context_ = nullptr;
  std::vector<std::uint8_t> surface_;  // what OSMesa insists on; pictures go to framebuffers of ours
  std::unique_ptr<Programs> programs_;
  Target picture_, face_;
  MeasureTarget measured_, measured_face_;
  Shadow shadow_;
  FaceStore faces_{GL_LINEAR, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
  FaceStore measured_faces_{GL_NEAREST, GL_RG32F, GL_RG, GL_FLOAT};
  GLuint colour_map_ = 0, empty_ = 0;
  std::vector<GLuint> textures_;
  std::vector<Geometry> meshes_, planes_;
  std::vector<std::array<V3, 2>> plane_axes_;
  V3 key_{}, fill_{}, rim_{};
  M4 light_{};
};

}  // namespace mortise::render::module
