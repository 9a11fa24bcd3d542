#include "run/pictures.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "render/from_scene.h"
#include "render/renderer.h"

namespace mortise::run {

struct Pictures::State {
  render::SceneView view;
  render::Renderer renderer;
  std::string folder;
  bool is_static;
};

Pictures::Pictures(const Params& scene, const model::ModelInput& input, const std::string& folder)
    : state_(new State{{scene, input.bodies}, {}, folder, scene.at("time").text("mode") == "static"}) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw Error(Exit::file, "cannot make the folder " + folder + ": " + failed.message());
}

Pictures::~Pictures() = default;

void Pictures::draw(long frame, double time, const std::vector<double>& points, const std::map<std::string, std::vector<double>>& fields) {
  State& s = *state_;
  s.view.move(points);
  const std::string caption = s.is_static ? fmt::format("load {:.3f}   frame {}", time, frame) : fmt::format("t = {:.4f} s   frame {}", time, frame);
  for (const std::string& camera : s.view.cameras())
    render::write_png(fmt::format("{}/{}_{:04d}.png", s.folder, camera, frame), s.renderer.draw(s.view.job(camera, fields, caption)));
}

}  // namespace mortise::run
