// mortise info: what this build is and what it runs on.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/json_text.h"
#include "base/version.h"
#include "cli/commands.h"
#include "engine/api.h"
#include "run/libraries.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

Json facts() {
  engine::cpu_api().set_threads(0);  // for runs as this is said of: it chooses kernels of OpenBLAS
  Json devices = Json::array(), kernels = engine::cpu_api().architectures();
  std::string no_cuda;
  std::vector<device::DeviceInfo> found = engine::cpu_api().devices(nullptr);
  if (const engine::Api* cuda = engine::cuda_api(no_cuda)) {
    const auto gpus = cuda->devices(&no_cuda);
    for (const std::string& a : cuda->architectures()) kernels.push_back(a);
    found.insert(found.end(), gpus.begin(), gpus.end());
  }
  for (const device::DeviceInfo& d : found)
    devices.push_back({{"kind", d.kind},
                       {"name", d.name},
                       {"threads", d.threads},
                       {"memory_bytes", d.memory},
                       {"driver", d.driver},
                       {"runtime", d.runtime},
                       {"architecture", d.architecture}});
  return {{"version", version()}, {"commit", git_sha1()},   {"build_type", build_type()}, {"compiler", "g++ " __VERSION__},
          {"devices", devices},   {"kernels_for", kernels}, {"no_gpu_because", no_cuda},  {"libraries", run::libraries()}};
}

int cmd_info(bool json) {
  const Json all = facts();
  if (json) {
    std::cout << json_text(all, 2) << "\n";
    return 0;
  }
  std::cout << version_text() << ", " << all["build_type"].get<std::string>() << " build, " << all["compiler"].get<std::string>() << "\n\ndevices\n";
  int gpus = 0;
  for (const Json& d : all["devices"]) {
    const bool gpu = d["kind"] == "cuda";
    std::cout << "  " << d["kind"].get<std::string>() << (gpu ? ":" + std::to_string(gpus++) : "") << "  " << d["name"].get<std::string>() << ", "
              << d["threads"] << (gpu ? " multiprocessors, " : " threads, ") << d["memory_bytes"].get<std::size_t>() / (1 << 20) << " MiB";
    if (gpu)
      std::cout << ", " << d["architecture"].get<std::string>() << ", driver for CUDA " << d["driver"].get<std::string>() << ", runtime "
                << d["runtime"].get<std::string>();
    std::cout << "\n";
  }
  if (const std::string why = all["no_gpu_because"]; !why.empty()) std::cout << "  no GPU: " << why << "\n";
  std::cout << "kernels for";
  for (const Json& a : all["kernels_for"]) std::cout << " " << a.get<std::string>();
  std::cout << "\n\nlibraries\n";
  for (const auto& [name, version] : all["libraries"].items()) std::cout << "  " << name << " " << version.get<std::string>() << "\n";
  return 0;
}

}  // namespace

std::string version_text() {
  const std::string commit = git_sha1();
  return std::string("mortise ") + version() + (commit.empty() ? "" : " (" + commit + ")");
}

void add_info(Command app, Context& context) {
  const Command sub = app.command("info", "version, build, devices and libraries");
  auto json = std::make_shared<bool>(false);
  sub.flag("--json", *json, "as one JSON object");
  sub.footer("Examples:\n  mortise info\n  mortise info --json");
  sub.action([json, &context] { context.action = [json] { return cmd_info(*json); }; });
}

}  // namespace mortise::cli
