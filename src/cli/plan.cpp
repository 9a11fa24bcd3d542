#include "cli/plan.h"

#include <fmt/format.h>

#include <set>

#include "audit/volumetric.h"
#include "cost/predict.h"
#include "effects/contact/layer.h"
#include "effects/roles.h"
#include "engine/effect_tables.h"
#include "engine/engine.h"
#include "engine/input.h"
#include "engine/memory_needed.h"
#include "run/check_start.h"
#include "scene/pass_through.h"
#include "sensors/sensors.h"

namespace mortise::cli {

std::string plan_text(const Params& scene) {
  const model::ModelInput input = engine::make_input(scene);
  const std::unique_ptr<engine::Engine> engine = run::check_start(scene, input);

  const std::vector<std::string> names = effects::of_role(scene.at("effects"), effects::Role::contact);
  const std::set<std::string> contact(names.begin(), names.end());
  std::string text;
  std::size_t total = 0;
  for (const model::BodyInput& b : input.bodies) {
    if (b.type == model::BodyType::half_space) continue;
    text += fmt::format("body    {:20} {:>8} nodes {:>8} tets {:>8} surface triangles\n", b.name, b.nodes.size(), b.tets.size(), b.triangles.size());
    if (b.type == model::BodyType::soft) text += fmt::format("        change of volume {}\n", audit::volumetric(b));
  }
  for (const engine::PlanItem& item : engine->plan()) {
    text += "effect  " + item.effect + "\n";
    for (const auto& [what, bytes] : item.buffers) {
      text += fmt::format("        buffer {:24} {:>12} bytes\n", what, bytes);
      total += bytes;
    }
    for (const std::string& kernel : item.kernels) text += "        kernel " + kernel + "\n";
    if (contact.count(item.effect)) {
      const Params& own = scene.at("effects").at(item.effect);
      text +=
          fmt::format("        d_hat {:.4g} m{}\n", effects::contact::support_radius(own, input), own.has("d_hat") ? "" : ", chosen from the mesh");
    }
  }
  for (const scene::PassThrough& p : scene::pass_through(scene, engine::effect_tables())) text += "passes  " + p.text() + "\n";
  const sensors::Sensors sensors(input);
  for (const sensors::Sensor& s : sensors.all())
    text += fmt::format("sensor  {:20} {} x {} taxels on '{}'\n        buffer {:24} {:>12} bytes\n", s.name(), s.spec().rows, s.spec().columns,
                        s.body(), "grid on the surface", s.bytes());
  text += fmt::format("solver  {}\n", engine->linear_solver());
  text += fmt::format("memory  {:.1f} MiB in the buffers above, {:.1f} MiB in all buffers so far\n", static_cast<double>(total) / (1 << 20),
                      static_cast<double>(engine->peak_memory()) / (1 << 20));
  text += fmt::format(
      "        about {:.1f} MiB on the device in all, with conjugate gradients; wide contact and the factor of a direct solver come on top\n",
      static_cast<double>(engine::memory_needed(input)) / (1 << 20));
  text += "time    " + cost::predict(input, *engine) + "\n";
  return text;
}

}  // namespace mortise::cli
