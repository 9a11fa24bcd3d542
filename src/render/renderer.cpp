#include "render/renderer.h"

#include <dlfcn.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>

#include "base/error.h"
#include "render/api.h"
#include "render/camera.h"
#include "render/colour_map.h"
#include "render/overlay.h"

namespace mortise::render {
namespace {

constexpr const char* kModule = "libmortise_render.so";
constexpr int kMessage = 512;

std::vector<std::filesystem::path> module_places() {
  std::vector<std::filesystem::path> places;
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) places = {program.parent_path() / kModule, program.parent_path().parent_path() / "lib" / kModule};
  places.emplace_back(std::filesystem::path(MORTISE_MODULE_FOLDER) / kModule);
  return places;
}

void put(float* to, const Vec3& v) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(v[k]);
}
Vec3 linear(const Vec3& srgb) { return {linear_of_srgb(srgb[0]), linear_of_srgb(srgb[1]), linear_of_srgb(srgb[2])}; }

// Float copies of a mesh, with the triangles sorted by material.
struct Packed {
  std::vector<float> positions, normals, uvs, scalars;
  std::vector<std::int32_t> corners;
  std::vector<MortiseRenderPart> parts;
};

void pack_vectors(std::vector<float>& to, const std::vector<Vec3>& from, const Vec3& origin) {
  to.reserve(3 * from.size());
  for (const Vec3& p : from)
    for (int k = 0; k < 3; ++k) to.push_back(static_cast<float>(p[k] - origin[k]));
}

}  // namespace

struct Renderer::Module {
  void* handle = nullptr;
  const MortiseRenderApi* api = nullptr;
  MortiseRenderContext* context = nullptr;
  // Keeps the texture alive, so that its address stays its name.
  std::map<const Texture*, std::pair<std::shared_ptr<const Texture>, int>> textures;

  ~Module() {
    if (context != nullptr) api->destroy(context);
    // The module stays loaded: LLVM does not survive being unloaded.
  }

  int texture_of(const std::shared_ptr<const Texture>& texture) {
    if (!texture) return 0;
    const auto known = textures.find(texture.get());
    if (known != textures.end()) return known->second.second;
    const int id = api->add_texture(context, texture->rgba.data(), texture->width, texture->height);
    if (id == 0)
      throw Error(Exit::device,
                  "the renderer cannot take a texture of " + std::to_string(texture->width) + " x " + std::to_string(texture->height) + " pixels");
    textures[texture.get()] = {texture, id};
    return id;
  }

  Packed pack(const Drawn& drawn, const Vec3& origin) {
    const DrawMesh& mesh = *drawn.mesh;
    Packed p;
    pack_vectors(p.positions, mesh.points, origin);
    pack_vectors(p.normals, mesh.normals, Vec3::Zero());
    for (const Vec2& uv : mesh.uvs) p.uvs.insert(p.uvs.end(), {static_cast<float>(uv[0]), static_cast<float>(uv[1])});
    p.scalars.assign(drawn.scalar.begin(), drawn.scalar.end());
    for (std::size_t m = 0; m < mesh.materials.size(); ++m) {
      const auto first = static_cast<std::int32_t>(p.corners.size() / 3);
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if ((mesh.material.empty() ? 0 : mesh.material[t]) == static_cast<Index>(m))
          p.corners.insert(p.corners.end(), mesh.triangles[t].v, mesh.triangles[t].v + 3);
      const auto count = static_cast<std::int32_t>(p.corners.size() / 3) - first;
      if (count == 0) continue;
      const Material& material = mesh.materials[m];
      MortiseRenderPart part{first, count, {}, static_cast<float>(material.roughness), static_cast<float>(material.metallic), 0};
      put(part.colour, material.colour);
      part.texture = mesh.uvs.empty() ? 0 : texture_of(material.texture);
      p.parts.push_back(part);
    }
    return p;
  }
};

Renderer::Renderer() : module_(std::make_unique<Module>()) {
  std::string tried;
  for (const auto& place : module_places()) {
    if (!std::filesystem::exists(place)) {
      tried += "\n  " + place.string() + ": not there";
      continue;
    }
    module_->handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module_->handle != nullptr) break;
    tried += std::string("\n  ") + dlerror();
  }
  if (module_->handle == nullptr) throw Error(Exit::device, std::string("no pictures: the drawing module ") + kModule + " cannot be loaded" + tried);
  const auto entry = reinterpret_cast<MortiseRenderEntry>(dlsym(module_->handle, "mortise_render_api"));
  module_->api = entry != nullptr ? entry() : nullptr;
  if (module_->api == nullptr || module_->api->version != MORTISE_RENDER_API)
    throw Error(Exit::device, std::string("no pictures: the drawing module ") + kModule + " belongs to another version");
  char message[kMessage] = "";
  module_->context = module_->api->create(message, kMessage);
  if (module_->context == nullptr) throw Error(Exit::device, std::string("no pictures: ") + message);
}

Renderer::~Renderer() = default;

void check_job(const RenderJob& job) {
  if (job.width < 1 || job.height < 1 || job.width > 8192 || job.height > 8192)
    throw Error(Exit::scene, "a picture has between 1 and 8192 pixels a side");
  if (!has_pose(job.camera))
    throw Error(Exit::scene, "a camera needs a look_at away from its position and an up that is not along the line of sight");
  const double widest = job.camera.model == Camera::Model::fisheye ? 2 * M_PI + 1e-9 : M_PI - 1e-3;
  if (!(job.camera.fov > 0 && job.camera.fov <= widest)) throw Error(Exit::scene, "the field of view of a camera is out of range");
}

namespace {

// A job as the module takes it, and what it points to.
struct Prepared {
  Vec3 origin;  // floats are relative to the middle of what is drawn
  std::vector<Packed> packed;
  std::vector<int> ids;  // of the meshes
  std::vector<MortiseRenderMesh> meshes;
  std::vector<MortiseRenderPlane> planes;
  ColourMap map;
  MortiseRenderJob raw{};
};

void prepare(const RenderJob& job, Prepared& p, const std::function<Packed(const Drawn&, const Vec3&)>& pack) {
  check_job(job);
  Eigen::AlignedBox3d box;
  for (const Drawn& d : job.meshes)
    for (const Vec3& x : d.mesh->points) box.extend(x);
  if (box.isEmpty()) box.extend(job.camera.look_at);
  p.origin = box.center();
  const double radius = std::max(0.5 * box.diagonal().norm(), 1e-3 * (job.camera.look_at - job.camera.position).norm());

  for (const Drawn& d : job.meshes) {
    if (d.mesh->triangles.empty()) continue;
    p.packed.push_back(pack(d, p.origin));
    p.ids.push_back(d.id);
  }
  for (const Packed& m : p.packed)
    p.meshes.push_back({static_cast<std::int32_t>(m.positions.size() / 3), static_cast<std::int32_t>(m.corners.size() / 3),
                        static_cast<std::int32_t>(m.parts.size()), m.positions.data(), m.normals.data(), m.uvs.empty() ? nullptr : m.uvs.data(),
                        m.scalars.empty() ? nullptr : m.scalars.data(), m.corners.data(), m.parts.data()});
  for (const GroundPlane& g : job.planes) {
    MortiseRenderPlane& plane = p.planes.emplace_back();
    put(plane.point, g.point - p.origin);
    put(plane.normal, g.normal.normalized());
    put(plane.colour, linear(g.colour));
    plane.checker = static_cast<float>(g.checker);
  }

  const ColourBar bar = job.bar.value_or(ColourBar{});
  p.map = map_for(bar.low, bar.high);
  MortiseRenderJob& raw = p.raw;
  raw.width = job.width, raw.height = job.height;
  raw.meshes = static_cast<std::int32_t>(p.meshes.size()), raw.mesh = p.meshes.data();
  raw.planes = static_cast<std::int32_t>(p.planes.size()), raw.plane = p.planes.data();
  raw.camera.fisheye = job.camera.model == Camera::Model::fisheye ? 1 : 0;
  raw.camera.fov = static_cast<float>(job.camera.fov);
  const Pose pose = pose_of(job.camera);
  put(raw.camera.position, job.camera.position - p.origin);
  put(raw.camera.forward, pose.forward);
  put(raw.camera.up, -pose.down);
  put(raw.world_up, job.camera.up.normalized());
  put(raw.background_top, linear(job.background_top));
  put(raw.background_bottom, linear(job.background_bottom));
  raw.radius = static_cast<float>(radius);
  raw.colour_map = p.map.data();
  raw.scalar_low = static_cast<float>(bar.low), raw.scalar_high = static_cast<float>(bar.high);
}

}  // namespace

Image Renderer::draw(const RenderJob& job) {
  Prepared p;
  prepare(job, p, [&](const Drawn& d, const Vec3& origin) { return module_->pack(d, origin); });
  Image image{job.width, job.height, {}};
  image.rgb.resize(static_cast<std::size_t>(job.width) * job.height * 3);
  char message[kMessage] = "";
  if (module_->api->draw(module_->context, &p.raw, image.rgb.data(), message, kMessage) != 0)
    throw Error(Exit::device, std::string("drawing failed: ") + message);
  draw_overlays(image, job);
  return image;
}

Measurement Renderer::measure(const RenderJob& job) {
  Prepared p;
  prepare(job, p, [&](const Drawn& d, const Vec3& origin) { return module_->pack(d, origin); });
  const std::size_t pixels = static_cast<std::size_t>(job.width) * job.height;
  std::vector<std::int32_t> mesh(pixels);
  std::vector<float> distance(pixels);
  char message[kMessage] = "";
  if (module_->api->measure(module_->context, &p.raw, mesh.data(), distance.data(), message, kMessage) != 0)
    throw Error(Exit::device, std::string("drawing failed: ") + message);

  Measurement out{job.width, job.height, std::vector<int>(pixels, 0), std::vector<double>(pixels, std::numeric_limits<double>::infinity())};
  for (int y = 0; y < job.height; ++y)
    for (int x = 0; x < job.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * job.width + x;
      if (mesh[i] >= 0) out.id[i] = p.ids[static_cast<std::size_t>(mesh[i])], out.distance[i] = distance[i];
      const std::optional<Vec3> ray = job.planes.empty() ? std::nullopt : ray_of(job, x, y);
      if (!ray) continue;
      for (const GroundPlane& g : job.planes) {
        const double along = g.normal.dot(g.point - job.camera.position) / g.normal.dot(*ray);
        if (along > 0 && along < out.distance[i]) out.id[i] = g.id, out.distance[i] = along;
      }
    }
  return out;
}

}  // namespace mortise::render
