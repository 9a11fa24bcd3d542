#include "geometry/io/obj.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>

#include "geometry/io/normals.h"
#include "geometry/io/text.h"
#include "geometry/io/write.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

// The rest of a line after its first word as one name: file and material names may contain spaces.
std::string rest(const LineReader& in, std::size_t first, const char* what) {
  in.word(first, what);
  const std::string_view last = in.words().back();
  const char* begin = in.words()[first].data();
  return std::string(begin, last.data() + last.size() - begin);
}

std::string beside(const std::string& path, const std::string& name) {
  return (std::filesystem::path(path).parent_path() / name).lexically_normal().string();
}

// MTL: the subset that the renderer can show. https://en.wikipedia.org/wiki/Wavefront_.obj_file#Material_template_library
std::vector<VisualMaterial> read_mtl(const std::string& path) {
  const std::string text = read_file(path, max_bytes::materials);
  LineReader in(path, text);
  std::vector<VisualMaterial> materials;
  while (in.next()) {
    const std::string_view key = in.words()[0];
    if (key == "newmtl") {
      materials.push_back({});
      materials.back().name = rest(in, 1, "a material name");
      continue;
    }
    if (key[0] == '#') continue;
    const bool known = key == "Kd" || key == "Pr" || key == "Pm" || key == "map_Kd";
    if (!known) continue;
    if (materials.empty()) in.fail("'" + std::string(key) + "' before the first newmtl");
    VisualMaterial& m = materials.back();
    if (key == "Kd") m.base_color = in.vec3(1, "a colour component");
    if (key == "Pr") m.roughness = in.number(1, "a roughness");
    if (key == "Pm") m.metallic = in.number(1, "a metallic value");
    if (key == "map_Kd") {
      if (in.word(1, "a file name")[0] == '-') in.fail("options of map_Kd are not supported: give the file name only");
      m.texture.file = beside(path, rest(in, 1, "a file name"));
    }
  }
  return materials;
}

// OBJ counts from 1; negative numbers count back from the last one defined so far.
Index resolve(const LineReader& in, std::string_view word, std::size_t defined, const char* what) {
  long long i = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), i);
  if (error != std::errc() || end != word.data() + word.size()) in.fail("expected " + std::string(what) + ", found '" + std::string(word) + "'");
  const long long n = static_cast<long long>(defined);
  const long long at = i > 0 ? i - 1 : n + i;
  if (i == 0 || at < 0 || at >= n) in.fail(std::string(what) + " " + std::to_string(i) + " is not defined (" + std::to_string(n) + " so far)");
  return static_cast<Index>(at);
}

ObjFile::Corner read_corner(const LineReader& in, std::string_view word, const ObjFile& obj) {
  ObjFile::Corner c{-1, -1, -1};
  const std::size_t first = word.find('/');
  c.v = resolve(in, word.substr(0, first), obj.points.size(), "vertex");
  if (first == std::string_view::npos) return c;
  word.remove_prefix(first + 1);
  const std::size_t second = word.find('/');
  if (const std::string_view t = word.substr(0, second); !t.empty()) c.t = resolve(in, t, obj.uvs.size(), "texture vertex");
  if (second == std::string_view::npos) return c;
  if (const std::string_view n = word.substr(second + 1); !n.empty()) c.n = resolve(in, n, obj.normals.size(), "normal");
  return c;
}

}  // namespace

ObjFile parse_obj(const std::string& path, std::string_view text, bool materials) {
  LineReader in(path, text);
  ObjFile obj;
  Index material = -1, part = 0;
  bool part_used = false;
  const auto material_index = [&](const std::string& name) {
    for (std::size_t i = 0; i < obj.materials.size(); ++i)
      if (obj.materials[i].name == name) return static_cast<Index>(i);
    obj.materials.push_back({});
    obj.materials.back().name = name;
    return static_cast<Index>(obj.materials.size() - 1);
  };

  while (in.next()) {
    const std::string_view key = in.words()[0];
    if (key == "v") {
      obj.points.push_back(in.vec3(1, "a coordinate"));
    } else if (key == "vt") {
      obj.uvs.push_back({in.number(1, "a texture coordinate"), in.words().size() > 2 ? in.number(2, "a texture coordinate") : 0.0});
    } else if (key == "vn") {
      obj.normals.push_back(in.vec3(1, "a normal component"));
    } else if (key == "f") {
      std::vector<ObjFile::Corner> corners;
      for (std::size_t i = 1; i < in.words().size(); ++i) corners.push_back(read_corner(in, in.words()[i], obj));
      if (corners.size() < 3) in.fail("a face needs at least three vertices");
      if (material < 0) material = material_index("");
      for (std::size_t i = 2; i < corners.size(); ++i) obj.faces.push_back({{corners[0], corners[i - 1], corners[i]}, material, part});
      part_used = true;
    } else if (key == "usemtl") {
      material = material_index(rest(in, 1, "a material name"));
    } else if (key == "mtllib" && materials) {
      for (VisualMaterial& m : read_mtl(beside(path, rest(in, 1, "a file name")))) obj.materials[material_index(m.name)] = m;
    } else if (key == "o") {
      if (part_used) ++part;
      part_used = false;
    }
    if (in.words().back() == "\\") in.fail("continued lines (a trailing backslash) are not supported");
  }
  return obj;
}

ObjFile read_obj(const std::string& path) { return parse_obj(path, read_file(path), true); }

TriMesh surface_from(const ObjFile& obj) {
  TriMesh mesh;
  mesh.points = obj.points;
  for (const ObjFile::Face& f : obj.faces) mesh.triangles.push_back({{f.corner[0].v, f.corner[1].v, f.corner[2].v}});
  return without_unused_points(mesh);
}

VisualMesh visual_from(const ObjFile& obj) {
  VisualMesh mesh;
  mesh.materials = obj.materials;
  mesh.has_uvs = !obj.uvs.empty();
  std::map<std::array<Index, 3>, Index> vertex;  // (v, t, n) -> render vertex
  std::vector<Index> position;                   // of each render vertex: v, for normals across texture seams
  std::vector<char> has_normal;
  for (const ObjFile::Face& f : obj.faces) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      const ObjFile::Corner& c = f.corner[k];
      const auto [at, fresh] = vertex.try_emplace({c.v, c.t, c.n}, static_cast<Index>(mesh.points.size()));
      t.v[k] = at->second;
      if (!fresh) continue;
      mesh.points.push_back(obj.points[c.v]);
      mesh.uvs.push_back(c.t < 0 ? Vec2(0, 0) : obj.uvs[c.t]);
      mesh.normals.push_back(c.n < 0 ? Vec3(0, 0, 0) : obj.normals[c.n]);
      position.push_back(c.v);
      has_normal.push_back(c.n >= 0);
    }
    mesh.triangles.push_back(t);
    mesh.part.push_back(f.part);
    mesh.material.push_back(f.material);
  }
  complete_normals(mesh, position, has_normal);
  return mesh;
}

std::string obj_text(const TriMesh& mesh) {
  std::string out;
  for (const Vec3& p : mesh.points) {
    out += 'v';
    append_numbers(out, p.data(), 3);
  }
  for (const Triangle& t : mesh.triangles)
    out += "f " + std::to_string(t.v[0] + 1) + " " + std::to_string(t.v[1] + 1) + " " + std::to_string(t.v[2] + 1) + "\n";
  return out;
}

void write_obj(const std::string& path, const TriMesh& mesh) { write_file(path, obj_text(mesh)); }

}  // namespace mortise::geometry
