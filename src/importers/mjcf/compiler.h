#pragma once
// How a file means its numbers: <compiler>, and orientations, which may be said in five ways.
#include "importers/element.h"
#include "importers/robot/robot.h"

namespace mortise::importers::mjcf {

struct Compiler {
  double angle = 0.017453292519943295;   // [rad] of the file's unit of angles: degrees, if it says nothing
  std::string euler = "xyz";             // axes of Euler angles: small letters turn with the body, capitals stay
  std::string meshes, textures, assets;  // folders
  bool strip = false;                    // names of files lose their folders
  bool fit_box = false;                  // primitives that stand for a mesh fit the box around it
  bool auto_limits = true;               // a range that is given holds, if nothing says otherwise
  enum class Inertia { own, either, shapes } inertia = Inertia::either;
  int groups[2] = {0, 5};  // of the geoms that weigh

  void read(const Element& e, Notes& notes);
  std::string mesh_file(const std::string& name) const { return file(meshes, name); }
  std::string texture_file(const std::string& name) const { return file(textures, name); }
  // Of an element's quat, axisangle, xyaxes, zaxis or euler.
  Mat3 turn(const Element& e) const;
  Pose pose(const Element& e) const { return {turn(e), e.vector("pos", Vec3::Zero())}; }

 private:
  std::string file(const std::string& folder, const std::string& name) const;
};

// The attributes that `pose` reads.
const std::vector<std::string>& pose_words();
Mat3 of_quaternion(const Element& e, const char* attribute);

}  // namespace mortise::importers::mjcf
