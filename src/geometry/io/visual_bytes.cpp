#include "geometry/io/visual_bytes.h"

#include "geometry/io/bytes.h"

namespace mortise::geometry {
namespace {

template <class List>
void put(std::string& out, const List& list) {
  const std::uint64_t n = list.size();
  out.append(reinterpret_cast<const char*>(&n), sizeof n);
  out.append(reinterpret_cast<const char*>(list.data()), n * sizeof(*list.data()));
}

template <class List>
void get(ByteReader& in, List& list) {
  using Value = typename List::value_type;
  const std::uint64_t n = in.read<std::uint64_t>("a length");
  if (n > in.left() / sizeof(Value)) in.fail("a list runs past the end");
  list.resize(n);
  const std::string_view bytes = in.raw(n * sizeof(Value), "a list");
  if (n > 0) std::memcpy(static_cast<void*>(list.data()), bytes.data(), bytes.size());
}

std::string numbers_of(const VisualMaterial& m) {
  const double numbers[] = {m.base_color[0], m.base_color[1], m.base_color[2], m.roughness, m.metallic};
  return std::string(reinterpret_cast<const char*>(numbers), sizeof numbers);
}

void check(const ByteReader& in, const VisualMesh& m) {
  const std::size_t n = m.points.size(), triangles = m.triangles.size();
  bool fits = m.normals.size() == n && m.uvs.size() == n && m.part.size() == triangles && m.material.size() == triangles;
  for (const Triangle& t : m.triangles)
    for (Index v : t.v) fits = fits && v >= 0 && static_cast<std::size_t>(v) < n;
  for (Index k : m.material) fits = fits && k >= 0 && static_cast<std::size_t>(k) < m.materials.size();
  for (Index k : m.part) fits = fits && k >= 0;
  if (!fits) in.fail("the lists do not fit together");
}

}  // namespace

std::string to_bytes(const VisualMesh& mesh) {
  std::string out;
  put(out, mesh.points), put(out, mesh.normals), put(out, mesh.uvs), put(out, mesh.triangles), put(out, mesh.part), put(out, mesh.material);
  out += mesh.has_uvs ? '\1' : '\0';
  for (const VisualMaterial& m : mesh.materials) {
    out += numbers_of(m);
    put(out, m.name), put(out, m.texture.file), put(out, m.texture.bytes);
  }
  return out;
}

VisualMesh visual_from_bytes(const std::string& path, const std::string& bytes) {
  ByteReader in(path, bytes, 0, std::endian::native);
  VisualMesh mesh;
  get(in, mesh.points), get(in, mesh.normals), get(in, mesh.uvs), get(in, mesh.triangles), get(in, mesh.part), get(in, mesh.material);
  mesh.has_uvs = in.read<char>("a flag") != 0;
  while (in.left() > 0) {
    VisualMaterial& m = mesh.materials.emplace_back();
    for (double* number : {&m.base_color[0], &m.base_color[1], &m.base_color[2], &m.roughness, &m.metallic}) *number = in.read<double>("a number");
    get(in, m.name), get(in, m.texture.file), get(in, m.texture.bytes);
  }
  check(in, mesh);
  return mesh;
}

}  // namespace mortise::geometry
