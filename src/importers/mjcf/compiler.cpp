#include "importers/mjcf/compiler.h"

#include <Eigen/Geometry>
#include <filesystem>

#include "geometry/rigid_motion.h"

namespace mortise::importers::mjcf {
namespace {

Vec3 unit(const Element& e, const char* attribute, const Vec3& v) {
  if (!(v.norm() > 0)) e.fail("attribute '" + std::string(attribute) + "' of <" + e.name() + "> has no direction");
  return v.normalized();
}

Mat3 of_axes(const Element& e) {
  const std::vector<double> v = e.numbers("xyaxes", 6);
  Mat3 R;
  R.col(0) = unit(e, "xyaxes", {v[0], v[1], v[2]});
  const Vec3 y(v[3], v[4], v[5]);
  R.col(1) = unit(e, "xyaxes", y - R.col(0) * R.col(0).dot(y));
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

bool truth(const Element& e, const char* attribute, bool fallback) {
  if (!e.has(attribute)) return fallback;
  const std::string word = e.text(attribute);
  if (word != "true" && word != "false")
    e.fail("attribute '" + std::string(attribute) + "' of <" + e.name() + "> is '" + word + "'; must be true or false");
  return word == "true";
}

}  // namespace

Mat3 of_quaternion(const Element& e, const char* attribute) {
  const std::vector<double> q = e.numbers(attribute, 4);
  const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  if (!(turn.norm() > 0)) e.fail("attribute '" + std::string(attribute) + "' of <" + e.name() + "> is zero");
  return turn.normalized().toRotationMatrix();
}

const std::vector<std::string>& pose_words() {
  static const std::vector<std::string> words{"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"};
  return words;
}

void Compiler::read(const Element& e, Notes& notes) {
  e.expect({"angle", "eulerseq", "meshdir", "assetdir", "strippath", "texturedir", "fitaabb", "autolimits", "inertiafromgeom", "inertiagrouprange",
            "coordinate"},
           {"lengthrange"},
           {"boundmass", "boundinertia", "settotalmass", "balanceinertia", "discardvisual", "usethread", "fusestatic", "exactmeshinertia",
            "alignfree", "saveinertial"},
           notes);
  const auto word = [&](const char* attribute, std::vector<std::string> known) {
    const std::string said = e.text(attribute);
    for (const std::string& k : known)
      if (said == k) return said;
    e.fail(with_hint("attribute '" + std::string(attribute) + "' of <compiler> is '" + said + "', which is unknown", said, known));
  };
  if (e.has("coordinate") && word("coordinate", {"local", "global"}) == "global")
    e.fail("global coordinates are not read; MuJoCo itself gave them up");
  if (e.has("angle") && word("angle", {"degree", "radian"}) == "radian") angle = 1;
  if (e.has("eulerseq")) {
    euler = e.text("eulerseq");
    if (euler.size() != 3 || euler.find_first_not_of("xyzXYZ") != std::string::npos)
      e.fail("attribute 'eulerseq' of <compiler> must be three of x, y, z, X, Y, Z");
  }
  assets = e.text("assetdir", assets), meshes = e.text("meshdir", meshes);
  textures = e.text("texturedir", textures), fit_box = truth(e, "fitaabb", fit_box);
  strip = truth(e, "strippath", strip), auto_limits = truth(e, "autolimits", auto_limits);
  if (e.has("inertiafromgeom")) {
    const std::string how = word("inertiafromgeom", {"true", "false", "auto"});
    inertia = how == "true" ? Inertia::shapes : how == "false" ? Inertia::own : Inertia::either;
  }
  if (e.has("inertiagrouprange")) {
    const std::vector<double> g = e.numbers("inertiagrouprange", 2);
    groups[0] = static_cast<int>(g[0]), groups[1] = static_cast<int>(g[1]);
  }
}

std::string Compiler::file(const std::string& folder, const std::string& name) const {
  namespace fs = std::filesystem;
  const fs::path file = strip ? fs::path(name).filename() : fs::path(name);
  return (fs::path(folder.empty() ? assets : folder) / file).string();
}

Mat3 Compiler::turn(const Element& e) const {
  const char* said = nullptr;
  for (const char* attribute : {"quat", "axisangle", "xyaxes", "zaxis", "euler"}) {
    if (!e.has(attribute) || (said != nullptr && e.has_own(said) && !e.has_own(attribute))) continue;  // its own goes before that of its class
    if (said != nullptr && e.has_own(said) == e.has_own(attribute))
      e.fail("<" + e.name() + "> is turned by '" + std::string(said) + "' and by '" + attribute + "'");
    said = attribute;
  }
  const std::string how = said == nullptr ? "" : said;
  if (how == "quat") return of_quaternion(e, "quat");
  if (how == "axisangle") {
    const std::vector<double> v = e.numbers("axisangle", 4);
    return Eigen::AngleAxisd(angle * v[3], unit(e, "axisangle", {v[0], v[1], v[2]})).toRotationMatrix();
  }
  if (how == "xyaxes") return of_axes(e);
  if (how == "zaxis") return geometry::turn_of_z(unit(e, "zaxis", e.vector("zaxis")));
  Mat3 R = Mat3::Identity();
  if (how == "euler") {
    const Vec3 angles = angle * e.vector("euler");
    for (int i = 0; i < 3; ++i) {
      const bool stays = euler[i] < 'a';
      const Mat3 one = Eigen::AngleAxisd(angles[i], Vec3::Unit(euler[i] - (stays ? 'X' : 'x'))).toRotationMatrix();
      R = stays ? Mat3(one * R) : Mat3(R * one);
    }
  }
  return R;
}

}  // namespace mortise::importers::mjcf
