#include "run/pictures.h"

#include <fmt/format.h>

#include "render/from_scene.h"
#include "render/renderer.h"
#include "run/folder.h"

namespace mortise::run {

struct Pictures::State {
  render::SceneView view;
  render::Renderer renderer;
  std::string folder;
};

Pictures::Pictures(const Params& scene, const model::ModelInput& input, const std::string& folder)
    : state_(new State{render::SceneView(scene, input.bodies), {}, folder}) {
  make_pictures_folder(folder);
}
Pictures::~Pictures() = default;

void Pictures::draw(long frame, double time, const std::vector<double>& points, const std::map<std::string, std::vector<double>>& fields) {
  state_->view.move(points);
  for (const std::string& camera : state_->view.cameras()) {
    const render::RenderJob job = state_->view.job(camera, fields, fmt::format("t = {:.4g} s", time));
    const std::string path = fmt::format("{}/{}_{:04}.png", state_->folder, camera, frame);
    guard_picture(path);
    render::write_png(path, state_->renderer.draw(job));
  }
}

}  // namespace mortise::run
