#include "run/record.h"

#include "base/version.h"
#include "output/run_json.h"
#include "run/libraries.h"

namespace mortise::run {

void Record::write(const std::string& path, const End& end, const engine::Engine* engine) const {
  output::RunRecord r;
  r.exit_code = end.status;
  r.message = end.message;
  r.mortise_version = version();
  r.git_sha1 = git_sha1();
  r.hardware = output::hardware();
  r.device = {device.kind, device.name, device.threads, static_cast<std::int64_t>(device.memory), device.driver, device.runtime, device.architecture};
  r.scene_name = end.scene_name;
  r.scene_path = end.options.scene;
  r.scene_sha256 = end.scene_sha256;
  r.command_line = output::command_line();
  r.libraries = libraries();
  r.wall_seconds = end.wall;
  r.seconds = seconds, r.cpu_seconds = cpu_seconds;
  r.host_memory_peak_bytes = output::peak_memory_bytes();
  r.frames = frames;
  if (engine) {
    r.linear_solver = engine->linear_solver();
    for (const auto& [key, value] : engine->clock().seconds) r.phases.push_back({key.first, key.second, value.first, value.second});
    for (const auto& [name, n] : engine->launches()) r.launches.emplace_back(name, n);
    for (const auto& [name, t] : {std::pair{"all", engine->transfers()}, std::pair{"steps", engine->step_transfers()}})
      r.transfers.push_back({name, t.to_device, t.bytes_to_device, t.to_host, t.bytes_to_host});
    for (const auto& [who, n] : engine->step_waits()) r.waits.emplace_back(who, n);
    r.device_memory_peak_bytes = static_cast<std::int64_t>(engine->peak_memory());
  }
  r.steps = steps;
  output::write_run_json(path, r);
}

}  // namespace mortise::run
