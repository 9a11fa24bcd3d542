#include "geometry/tetrahedralise_cache.h"

#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/read_file.h"
#include "base/sha256.h"
#include "geometry/cache_folder.h"
#include "geometry/topology.h"

namespace mortise::geometry {
namespace {

// Changes whenever the mesher or its parameters change, so that old results are not taken for new ones.
constexpr char kVersion[] = "mortise tet cache 1, CGAL Mesh_3 5.5";

template <class T>
void put(std::string& out, const std::vector<T>& values) {
  const std::uint64_t n = values.size();
  out.append(reinterpret_cast<const char*>(&n), sizeof n);
  out.append(reinterpret_cast<const char*>(values.data()), n * sizeof(T));
}

template <class T>
bool get(std::string_view& in, std::vector<T>& values) {
  std::uint64_t n = 0;
  if (in.size() < sizeof n) return false;
  std::memcpy(&n, in.data(), sizeof n);
  in.remove_prefix(sizeof n);
  if (n > in.size() / sizeof(T)) return false;
  values.resize(n);
  std::memcpy(static_cast<void*>(values.data()), in.data(), n * sizeof(T));
  in.remove_prefix(n * sizeof(T));
  return true;
}

// The checksum tells damage, not who wrote it: numbers of points and volumes are looked at too.
bool sound(const TetMesh& mesh) {
  for (const Vec3& x : mesh.points)
    if (!x.allFinite()) return false;
  for (const Tet& t : mesh.tets) {
    for (Index v : t.v)
      if (v < 0 || static_cast<std::size_t>(v) >= mesh.points.size()) return false;
    if (!(tet_volume(mesh.points, t) > 0)) return false;
  }
  return !mesh.tets.empty();
}

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Tet) == 4 * sizeof(Index) && sizeof(Triangle) == 3 * sizeof(Index));

}  // namespace

TetCache::TetCache(const TriMesh& surface, const TetrahedraliseOptions& o) {
  std::string content(kVersion);
  put(content, surface.points);
  put(content, surface.triangles);
  put(content, std::vector<double>{o.edge_length, o.surface_edge_length, o.facet_distance, o.feature_angle, o.facet_angle, o.radius_edge_ratio});
  key_ = sha256(content);
  const std::filesystem::path folder = cache_folder();
  if (!folder.empty()) file_ = (folder / ("tets-" + key_ + ".bin")).string();
}

std::optional<TetMesh> TetCache::load() const {
  if (file_.empty()) return {};
  std::string all;
  try {
    all = read_regular_file(file_, max_bytes::mesh);
  } catch (const Error&) {
    return {};  // none, or nothing of ours: the mesh is made again
  }
  constexpr std::size_t kHash = 64;  // hexadecimal digits
  if (all.size() < 2 * kHash) return {};
  std::string_view body(all.data(), all.size() - kHash);
  if (sha256(body) != std::string_view(all).substr(body.size()) || body.substr(0, kHash) != key_) return {};
  body.remove_prefix(kHash);
  TetMesh mesh;
  if (!get(body, mesh.points) || !get(body, mesh.tets) || !body.empty() || !sound(mesh)) return {};
  return mesh;
}

void TetCache::store(const TetMesh& mesh) const {
  if (file_.empty()) return;
  std::string body = key_;
  put(body, mesh.points);
  put(body, mesh.tets);
  body += sha256(body);

  // A name of its own per process and call: jobs that share a cache never write into each other's file.
  static std::atomic<int> call = 0;
  const std::string aside = file_ + "." + std::to_string(::getpid()) + "-" + std::to_string(++call);
  std::error_code error;
  std::filesystem::create_directories(std::filesystem::path(file_).parent_path(), error);
  std::ofstream out(aside, std::ios::binary);
  out.write(body.data(), static_cast<std::streamsize>(body.size()));
  out.close();
  if (out) std::filesystem::rename(aside, file_, error);
  if (!out || error) std::filesystem::remove(aside, error);
}

}  // namespace mortise::geometry
