#include "cost/speed.h"

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/cpu_time.h"
#include "base/json_text.h"
#include "base/version.h"
#include "cost/tuning.h"
#include "engine/choose.h"
#include "engine/effect_tables.h"
#include "engine/input.h"
#include "geometry/cache_folder.h"
#include "output/atomic_file.h"
#include "output/hardware.h"
#include "scene/scene.h"

namespace mortise::cost {
namespace {

// A block of 1,800 nodes on a half-space under a load that bends it: elements, factors and contact in the proportions of a small scene.
constexpr const char* kSmallScene = R"(
mortise: 1
name: speed
time: {mode: static, steps: 4}
materials: {rubber: {youngs_modulus: 1 MPa, poisson_ratio: 0.4, density: 1000 kg/m^3}}
bodies:
  block: {type: soft, shape: {box: {size: [24 mm, 24 mm, 12 mm], edge_length: 1.72 mm}}, material: rubber, position: [0, 0, 6.05 mm]}
  floor: {type: half_space}
effects:
  elasticity: {}
  pin: [{body: block, where: {side: z_max}, motion: {time: [0, 1], translation: [[0, 0, 0], [0.5 mm, 0, -1 mm]]}}]
  barrier_contact: {d_hat: 0.1 mm, pairs: [[block, floor]]}
)";

double small_scene() {
  const scene::Scene scene = scene::read_scene_text(kSmallScene, "<small scene>", {}, engine::effect_tables());
  const model::ModelInput input = engine::make_input(scene.root);
  const auto must = [](const engine::Outcome& o) {
    if (o.code != 0) throw Error(static_cast<Exit>(o.code), "the small scene that measures this machine failed: " + o.message);
  };
  std::unique_ptr<engine::Engine> engine;
  must(engine::choose("cpu", 1).api->create(input, engine));
  must(engine->begin());
  const double start = cpu_time();
  for (long step = 0; step < scene.root.at("time").integer("steps"); ++step) {
    solver::StepReport report;
    must(engine->step([] { return false; }, report));
  }
  return cpu_time() - start;
}

}  // namespace

Speed speed_of_machine() {
  using Json = nlohmann::ordered_json;
  const std::filesystem::path folder = geometry::cache_folder();
  const std::string path = folder.empty() ? "" : (folder / "speed.json").string(), cpu = output::hardware().cpu;
  const std::string version = std::string(mortise::version()) + " " + git_sha1();
  if (!path.empty() && std::filesystem::is_regular_file(path)) {
    const Json j = Json::parse(output::read_file(path), nullptr, false);
    if (j.is_object() && j.value("cpu", "") == cpu && j.value("version", "") == version && j.contains("seconds") && j["seconds"].is_number())
      if (const double s = j["seconds"].get<double>(); s > 0 && std::isfinite(s))
        return {s / tuning::kReferenceSeconds, j.value("load", 0.0), j.value("date", ""), false};
  }
  Speed out;
  double load = 0;
  if (getloadavg(&load, 1) == 1) out.load = load;
  const double seconds = std::min(small_scene(), small_scene());
  const std::time_t now = std::time(nullptr);
  char date[16];
  std::strftime(date, sizeof date, "%F", std::localtime(&now));
  out.slowness = seconds / tuning::kReferenceSeconds, out.date = date, out.now = true;
  if (path.empty()) return out;
  std::error_code ec;
  std::filesystem::create_directories(folder, ec);
  try {
    output::write_file_atomically(
        path, json_text(Json{{"cpu", cpu}, {"version", version}, {"seconds", seconds}, {"load", out.load}, {"date", date}}, 1) + "\n", false);
  } catch (const Error&) {
    // A folder that cannot be written: it is measured again next time.
  }
  return out;
}

}  // namespace mortise::cost
