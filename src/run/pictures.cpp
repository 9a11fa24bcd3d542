#include "run/pictures.h"

#include <fmt/format.h>

#include "output/atomic_file.h"
#include "render/from_scene.h"
#include "render/renderer.h"
#include "run/camera_file.h"
#include "run/folder.h"

namespace mortise::run {

struct Pictures::State {
  render::SceneView view;
  render::Renderer renderer;
  std::string folder;
  const Params cameras;
};

Pictures::Pictures(const Params& scene, const model::ModelInput& input, const std::string& folder)
    : state_(new State{render::SceneView(scene, input.bodies), {}, folder, scene.at("render").at("cameras")}) {
  make_pictures_folder(folder);
}
Pictures::~Pictures() = default;

void Pictures::draw(long frame, double time, const std::vector<double>& points, const std::map<std::string, std::vector<double>>& fields) {
  state_->view.move(points);
  for (const std::string& name : state_->view.cameras()) {
    const Params& camera = state_->cameras.at(name);
    const render::RenderJob job = state_->view.job(name, fields, fmt::format("t = {:.4g} s", time));
    const CameraFiles files = camera_files(camera, name, frame);
    const auto place = [&](const std::string& file) {
      std::string path = state_->folder + "/" + file;
      guard_picture(path);
      return path;
    };
    if (!files.color.empty()) render::write_png(place(files.color), state_->renderer.draw(job));
    if (!files.depth.empty() || !files.depth_float.empty() || !files.segmentation.empty()) {
      const render::Measurement seen = state_->renderer.measure(job);
      if (!files.depth.empty()) render::write_png(place(files.depth), depth_image(seen, depth_unit(camera)));
      if (!files.depth_float.empty()) output::write_file_atomically(place(files.depth_float), depth_array(seen), false);
      const std::size_t bodies = state_->view.labels().size();
      if (!files.segmentation.empty() && bodies <= 255)
        render::write_png(place(files.segmentation), segmentation_image(seen, bodies));
      else if (!files.segmentation.empty())
        render::write_png(place(files.segmentation), segmentation_counts(seen));
    }
    output::write_file_atomically(place(files.file), camera_json(files, camera, name, job, state_->view.labels(), frame, time), false);
  }
  if (frame == 0) state_->view.forget_scales();
}

}  // namespace mortise::run
