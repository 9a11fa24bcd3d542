#include "exporters/glb.h"

#include <algorithm>
#include <fstream>
#include <limits>

#include "base/error.h"
#include "base/json_text.h"
#include "output/atomic_file.h"

namespace mortise::exporters {
namespace {

constexpr int kFloat = 5126, kUnsigned = 5125, kShort = 5123, kVertices = 34962, kTriangles = 34963, kNoTarget = 0;  // of OpenGL

void append(std::string& to, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) to.push_back(static_cast<char>(value >> shift & 255));
}

}  // namespace

int Glb::view(const void* data, std::size_t bytes, int target) {
  Json& views = json["bufferViews"];
  Json one = {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes}};
  if (target != kNoTarget) one["target"] = target;
  views.push_back(std::move(one));
  buffer_.append(static_cast<const char*>(data), bytes);
  buffer_.append((4 - buffer_.size() % 4) % 4, '\0');
  return static_cast<int>(views.size()) - 1;
}

int Glb::accessor(int view, int component, std::size_t count, const char* type) {
  Json& all = json["accessors"];
  all.push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
  return static_cast<int>(all.size()) - 1;
}

int Glb::vectors(std::span<const Vec3> values) {
  std::vector<float> floats;
  std::vector<float> low(3, std::numeric_limits<float>::max()), high(3, std::numeric_limits<float>::lowest());
  floats.reserve(3 * values.size());
  for (const Vec3& v : values)
    for (std::size_t k = 0; k < 3; ++k) {
      floats.push_back(static_cast<float>(v[static_cast<Eigen::Index>(k)]));
      low[k] = std::min(low[k], floats.back()), high[k] = std::max(high[k], floats.back());
    }
  const int index = accessor(view(floats.data(), 4 * floats.size(), kVertices), kFloat, values.size(), "VEC3");
  json["accessors"][static_cast<std::size_t>(index)]["min"] = low;
  json["accessors"][static_cast<std::size_t>(index)]["max"] = high;
  return index;
}

int Glb::uvs(std::span<const Vec2> values) {
  std::vector<float> floats;
  for (const Vec2& v : values) floats.insert(floats.end(), {static_cast<float>(v[0]), static_cast<float>(1 - v[1])});
  return accessor(view(floats.data(), 4 * floats.size(), kVertices), kFloat, values.size(), "VEC2");
}

int Glb::colours(std::span<const std::uint16_t> rgba) {
  const int index = accessor(view(rgba.data(), 2 * rgba.size(), kVertices), kShort, rgba.size() / 4, "VEC4");
  json["accessors"][static_cast<std::size_t>(index)]["normalized"] = true;
  return index;
}

int Glb::indices(std::span<const std::uint32_t> values) {
  return accessor(view(values.data(), 4 * values.size(), kTriangles), kUnsigned, values.size(), "SCALAR");
}

int Glb::numbers(std::span<const float> values, const char* type) {
  const std::size_t components = std::string(type) == "VEC4" ? 4 : std::string(type) == "VEC3" ? 3 : 1;
  const int index = accessor(view(values.data(), 4 * values.size(), kNoTarget), kFloat, values.size() / components, type);
  if (components == 1) {  // times of animations need bounds
    Json& one = json["accessors"][static_cast<std::size_t>(index)];
    one["min"] = {*std::min_element(values.begin(), values.end())}, one["max"] = {*std::max_element(values.begin(), values.end())};
  }
  return index;
}

int Glb::image(std::span<const std::uint8_t> png) {
  json["images"].push_back({{"bufferView", view(png.data(), png.size(), kNoTarget)}, {"mimeType", "image/png"}});
  constexpr int kLinear = 9729, kLinearMipmaps = 9987, kRepeat = 10497;
  if (!json.contains("samplers"))
    json["samplers"] = {{{"magFilter", kLinear}, {"minFilter", kLinearMipmaps}, {"wrapS", kRepeat}, {"wrapT", kRepeat}}};
  json["textures"].push_back({{"sampler", 0}, {"source", json["images"].size() - 1}});
  return static_cast<int>(json["textures"].size()) - 1;
}

void Glb::write(const std::string& path) const {
  Json whole = json;
  whole["buffers"] = {{{"byteLength", buffer_.size()}}};
  std::string text = json_text(whole);
  text.append((4 - text.size() % 4) % 4, ' ');
  const std::uint64_t size = 12 + 8 + text.size() + 8 + buffer_.size();
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw Error(Exit::file, "'" + path + "' would be larger than the 4 GiB that the format can hold; --every or --frames make it smaller");
  std::string head = "glTF";
  append(head, 2), append(head, static_cast<std::uint32_t>(size)), append(head, static_cast<std::uint32_t>(text.size()));
  head += "JSON" + text;
  append(head, static_cast<std::uint32_t>(buffer_.size()));
  head += std::string("BIN\0", 4);
  const std::string part = path + ".part";
  std::ofstream out(part, std::ios::binary | std::ios::trunc);
  out.write(head.data(), static_cast<std::streamsize>(head.size())).write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  out.close();
  if (!out) {
    std::remove(part.c_str());
    throw Error(Exit::file, "cannot write '" + path + "'");
  }
  output::rename_file(part, path);
}

}  // namespace mortise::exporters
