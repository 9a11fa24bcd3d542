#include "cli/bench_result.h"

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "base/error.h"
#include "base/json_text.h"
#include "cli/commands.h"
#include "engine/choose.h"
#include "output/hardware.h"

namespace mortise::cli {

void write_result(const std::string& path, const std::string& benchmark, const nlohmann::ordered_json& rows) {
  const output::Hardware machine = output::hardware();
  const device::DeviceInfo& device = engine::chosen().device;
  double load[3] = {NAN, NAN, NAN};  // beside what ran here: one busy thread counts 1
  getloadavg(load, 3);
  const nlohmann::ordered_json j{
      {"benchmark", benchmark},
      {"program", version_text()},
      {"machine", {{"cpu", machine.cpu}, {"cores", machine.cores}, {"memory_bytes", machine.memory_bytes}, {"load_average", load}}},
      {"device", {{"kind", device.kind}, {"name", device.name}, {"threads", device.threads}, {"driver", device.driver}, {"runtime", device.runtime}}},
      {"rows", rows}};
  std::ofstream file(path);
  file << json_text(j, 1) << "\n";
  if (!file.flush()) throw Error(Exit::file, "cannot write '" + path + "'");
}

}  // namespace mortise::cli
