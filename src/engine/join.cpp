#include "engine/join.h"

#include <algorithm>

#include "effects/list.h"

namespace mortise::engine {

model::ModelInput join(const std::vector<const model::ModelInput*>& scenes) {
  model::ModelInput out;
  out.scene = scenes.at(0)->scene;
  for (std::size_t e = 0; e < scenes.size(); ++e) {
    out.scenes.push_back(scenes[e]->scene);
    for (const model::BodyInput& body : scenes[e]->bodies) {
      if (body.type == model::BodyType::half_space && e > 0) continue;  // in all environments
      out.bodies.push_back(body);
      out.bodies.back().env = static_cast<int>(e);
    }
  }
  return out;
}

std::string common_to_a_model(const Params& scene, const std::string& path) {
  std::vector<std::string> part{""};
  for (char c : path)
    if (c == '.')
      part.emplace_back();
    else
      part.back() += c;
  if (part.size() < 3) return "";
  if (part[0] == "bodies") {
    const Params* body = scene.at("bodies").find(part[1]);
    return body && body->text("type") == "half_space" ? "a half_space is in all environments of a model" : "";
  }
  if (part[0] != "effects") return "";
  const effects::Kind* kind = effects::find_kind(part[1]);
  if (!kind) return "";
  const auto& own = kind->own;
  const std::string& key = kind->table->is_list && part.size() > 3 ? part[3] : part[2];
  if (std::find(own.begin(), own.end(), key) != own.end()) return "";
  std::string can;
  for (const char* k : own) can += (can.empty() ? "" : ", ") + std::string(k);
  return part[1] + " has the same " + key + " in all environments of a model" + (can.empty() ? "" : "; what may differ there: " + can);
}

}  // namespace mortise::engine
