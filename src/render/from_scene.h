#pragma once
// From the blocks of a scene (`render`, and `visual` of the bodies) to pictures of a run.
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/params.h"
#include "geometry/rigid_motion.h"
#include "model/input.h"
#include "render/job.h"

namespace mortise::render {

Camera camera_of(const Params& camera);     // one entry of render.cameras
GroundPlane ground_of(const Params& body);  // a body of type half_space
// The label is the field's name, written with spaces; `low`, `high` in SI. Without a `unit` the numbers are SI and bare.
ColourBar bar_of(const Params& camera, double low, double high);

// What the images of a camera call a body: `id` counts the scene's bodies from 1, half spaces included.
struct BodyLabel {
  int id;
  std::string name, type;  // as the scene has them
};

// Everything of a scene's pictures that does not change from frame to frame, and the moving meshes.
class SceneView {
 public:
  // Reads visual meshes and textures and binds them to the bodies. Throws Error(Exit::scene | Exit::file).
  SceneView(const Params& scene, const std::vector<model::BodyInput>& bodies);
  ~SceneView();

  const std::vector<std::string>& cameras() const { return cameras_; }

  const std::vector<BodyLabel>& labels() const { return labels_; }

  // Moves all meshes: three coordinates per point [m], body after body (half spaces have none).
  void move(std::span<const double> points);

  // The bodies that move, as they are now, in the order of the scene; half spaces, which do not.
  struct Moved {
    const BodyLabel* label;
    const DrawMesh* mesh;
    geometry::Motion motion;  // the rigid one that is nearest to what the body has done since the start
  };
  std::vector<Moved> moved() const;
  // A field of the simulation's points at the vertices of these meshes; vectors by their length, 0 where there is nothing. Empty where it is not of
  // the points.
  std::vector<std::vector<double>> at_vertices(const std::vector<double>& field) const;
  std::vector<std::pair<const BodyLabel*, GroundPlane>> planes() const;
  Camera camera(const std::string& name) const;  // where it is now

  // What a camera sees now. `fields`: one value or vector (which colours by its length) per point by name, in SI. The job refers to the meshes of
  // this view. Without a `range` the colour scale spans the extremes of the field up to this frame.
  RenderJob job(const std::string& camera, const std::map<std::string, std::vector<double>>& fields, std::string caption);
  // Scales without a range begin anew: nothing was solved in a first state, and bodies that begin near to each other press by any force then.
  void forget_scales() { extremes_.clear(), longest_.clear(); }

 private:
  struct Body;
  const Params render_;
  std::vector<std::string> cameras_;
  std::vector<std::unique_ptr<Body>> bodies_;
  std::vector<BodyLabel> labels_;
  std::map<std::string, GroundPlane> planes_;
  std::vector<double> magnitudes(const std::vector<double>& field) const;  // one number per point, or none
  // Adds the arrows of a camera that asks for them to its job.
  void add_traction(RenderJob& job, const std::string& name, const std::map<std::string, std::vector<double>>& fields,
                    const std::function<bool(const std::string&)>& shown);
  std::map<std::string, std::pair<double, double>> extremes_;  // per camera
  std::map<std::string, double> longest_;                      // traction, per camera [Pa]
  std::size_t points_ = 0;
};

}  // namespace mortise::render
