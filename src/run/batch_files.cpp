#include "run/batch_files.h"

#include <fmt/format.h>

#include <filesystem>

#include "output/atomic_file.h"
#include "output/environment_fields.h"
#include "run/environment.h"
#include "run/folder.h"
#include "run/grid_picture.h"

namespace fs = std::filesystem;

namespace mortise::run {
namespace {

void write_fields(const std::string& folder, const std::vector<EnvironmentEnd>& ends) {
  std::vector<output::EnvironmentFields> all;
  for (std::size_t e = 0; e < ends.size(); ++e) {
    output::EnvironmentFields one{fs::path(environment_folder(folder, static_cast<long>(e))).filename().string(), ends[e].code, {}, {}};
    for (const std::string& run : ends[e].runs) one.runs.push_back(fs::path(run).lexically_relative(folder).string());
    for (const scene::Drawn& d : ends[e].drawn) one.values.emplace_back(d.path, d.value);
    all.push_back(std::move(one));
  }
  output::write_environment_fields(folder, all);
}

// All resets in one table.
void write_episodes(const Params& scene, const std::string& folder, const std::vector<EnvironmentEnd>& ends) {
  std::string text = "environment," + episodes_header(scene) + "\n";
  for (std::size_t e = 0; e < ends.size(); ++e)
    for (const Episode& episode : episodes_in(environment_folder(folder, static_cast<long>(e)))) text += fmt::format("{},{}\n", e, episode.line);
  output::write_file_atomically(folder + "/episodes.csv", text, true);
}

void draw_grid(const std::string& folder, const std::vector<EnvironmentEnd>& ends) {
  std::vector<Tile> tiles;
  for (std::size_t e = 0; e < ends.size(); ++e)
    if (!ends[e].runs.empty()) tiles.push_back({ends[e].runs.front() + "/frames", std::to_string(e)});
  draw_side_by_side(tiles, folder + "/frames");
}

}  // namespace

void write_batch_files(const Params& scene, const std::string& folder, const std::vector<EnvironmentEnd>& ends, bool drawn) {
  const Params& block = scene.at("environments");
  write_fields(folder, ends);
  if (block.has("reset")) write_episodes(scene, folder, ends);
  if (drawn && block.text("pictures") == "grid") draw_grid(folder, ends);
}

}  // namespace mortise::run
