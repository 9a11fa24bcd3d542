#include "exporters/obj.h"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <map>

#include "output/atomic_file.h"

namespace mortise::exporters {
namespace {

std::string base(const std::string& path) { return std::filesystem::path(path).filename().string(); }

std::string material_name(const std::string& body, std::size_t k) { return k == 0 ? body : fmt::format("{}_{}", body, k); }

void write_materials(const std::string& stem, const render::SceneView& view, bool coloured) {
  std::string text = "# mortise\n";
  std::map<const render::Texture*, std::string> textures;
  for (const render::SceneView::Moved& body : view.moved())
    for (std::size_t k = 0; k < body.mesh->materials.size(); ++k) {
      render::Material m = body.mesh->materials[k];
      if (coloured) m.colour = Vec3::Ones(), m.texture = nullptr;  // colours of vertices are multiplied
      // Kd is the linear colour, as most readers take it; Pr and Pm are roughness and metal of the usual extension.
      text += fmt::format("newmtl {}\nKd {:.6g} {:.6g} {:.6g}\nPr {:.6g}\nPm {:.6g}\nillum 2\n", material_name(body.label->name, k), m.colour[0],
                          m.colour[1], m.colour[2], m.roughness, m.metallic);
      if (!m.texture) continue;
      const auto [known, fresh] = textures.try_emplace(m.texture.get(), fmt::format("{}_texture_{}.png", stem, textures.size()));
      if (fresh) {
        const std::vector<std::uint8_t> png = render::png_bytes(*m.texture);
        output::write_file_atomically(known->second, {reinterpret_cast<const char*>(png.data()), png.size()}, false);
      }
      text += fmt::format("map_Kd {}\n", base(known->second));
    }
  output::write_file_atomically(stem + ".mtl", text, false);
}

}  // namespace

std::string obj_of_frame(const std::string& stem, long frame) { return fmt::format("{}_{:04}.obj", stem, frame); }

void write_objs(const std::string& stem, render::SceneView& view, const Frames& frames) {
  write_materials(stem, view, frames.colouring.has_value());
  for (std::size_t f = 0; f < frames.numbers.size(); ++f) {
    view.move(frames.points(f));
    std::string text = fmt::format("# mortise, frame {}, {:.9g} s; metres\nmtllib {}\n", frames.numbers[f], frames.times[f], base(stem + ".mtl"));
    auto out = std::back_inserter(text);
    long vertex = 1, uv = 1;  // OBJ counts from 1 over the whole file
    const std::vector<std::vector<double>> values =
        frames.colouring ? view.at_vertices(frames.colouring->values(f)) : std::vector<std::vector<double>>{};
    const std::vector<render::SceneView::Moved> bodies = view.moved();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const render::SceneView::Moved& body = bodies[b];
      const render::DrawMesh& m = *body.mesh;
      fmt::format_to(out, "o {}\n", body.label->name);
      for (std::size_t i = 0; i < m.points.size(); ++i) {
        fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}", m.points[i][0], m.points[i][1], m.points[i][2]);
        if (!values.empty()) {  // an extension that Blender, MeshLab and others read: sRGB from 0 to 1
          const std::uint8_t* c = frames.colouring->srgb(values[b][i]);
          fmt::format_to(out, " {:.4g} {:.4g} {:.4g}", c[0] / 255.0, c[1] / 255.0, c[2] / 255.0);
        }
        text += '\n';
      }
      for (const Vec2& t : m.uvs) fmt::format_to(out, "vt {:.7g} {:.7g}\n", t[0], t[1]);
      for (const Vec3& n : m.normals) fmt::format_to(out, "vn {:.5g} {:.5g} {:.5g}\n", n[0], n[1], n[2]);
      for (std::size_t k = 0; k < m.materials.size(); ++k) {
        fmt::format_to(out, "usemtl {}\n", material_name(body.label->name, k));
        for (std::size_t t = 0; t < m.triangles.size(); ++t) {
          if ((m.material.empty() ? 0 : m.material[t]) != static_cast<Index>(k)) continue;
          text += "f";
          for (const Index v : m.triangles[t].v) {
            if (m.uvs.empty())
              fmt::format_to(out, " {}//{}", vertex + v, vertex + v);
            else
              fmt::format_to(out, " {}/{}/{}", vertex + v, uv + v, vertex + v);
          }
          text += "\n";
        }
      }
      vertex += static_cast<long>(m.points.size()), uv += static_cast<long>(m.uvs.size());
    }
    output::write_file_atomically(obj_of_frame(stem, frames.numbers[f]), text, false);
  }
}

}  // namespace mortise::exporters
