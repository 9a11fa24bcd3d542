#pragma once
#include <string>
#include <vector>

#include "render/from_scene.h"

namespace mortise::run {

// What one camera writes of one frame, into the folder of the pictures; the names of those files.
struct CameraFiles {
  std::string file;                                     // the description: JSON
  std::string color, depth, depth_float, segmentation;  // empty: not written
};
CameraFiles camera_files(const Params& camera, const std::string& name, long frame);

double depth_unit(const Params& camera);  // [m] of one count

// How a body appears in segmentation images; id 0 is what no body covers.
std::array<std::uint8_t, 3> label_color(int id);

// Depth as 16-bit counts of `unit` [m]; 0 where nothing is seen, or nothing within 65,535 counts.
render::GrayImage depth_image(const render::Measurement& seen, double unit);
// Depth as a file of NumPy: float32, rows x columns [m], infinite where nothing is seen.
std::string depth_array(const render::Measurement& seen);
render::IndexedImage segmentation_image(const render::Measurement& seen, std::size_t bodies);  // at most 255 bodies
render::GrayImage segmentation_counts(const render::Measurement& seen);                        // of more: the ids themselves

// schemas/camera.md: intrinsics, pose, files and the bodies of the images.
std::string camera_json(const CameraFiles& files, const Params& camera, const std::string& name, const render::RenderJob& job,
                        const std::vector<render::BodyLabel>& bodies, long frame, double time);
// As far as their first bytes tell.
bool is_our_camera_file(const std::string& path);
bool is_our_depth_array(const std::string& path);

}  // namespace mortise::run
