// Trajectories from files: a motor by a column of text and of HDF5, a body along a track of poses with quaternions.
#include <fmt/format.h>
#include <hdf5.h>

#include <Eigen/Geometry>
#include <fstream>

#include "output/column_file.h"
#include "rig.h"
#include "scene/trajectory.h"

using namespace mortise;
using namespace mortise::testing;

namespace {

constexpr int kRows = 21;
double time_at(int i) { return 0.01 * i; }
double angle_at(int i) { return 20 * std::sin(0.3 * i); }  // [deg]
Eigen::Quaterniond turn_at(int i) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(0.02 * i, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(0.3 + 0.01 * i * i / 20.0, Vec3(0, 1, 0)));
}
Vec3 place_at(int i) { return {0.1 + 1e-3 * i, 0.2 * std::sin(0.1 * i) * 0.05, 0.05}; }

void write(hid_t file, const char* name, const std::vector<double>& v, hsize_t columns, const char* unit) {
  const hsize_t size[2] = {v.size() / columns, columns};
  const hid_t space = H5Screate_simple(columns == 1 ? 1 : 2, size, nullptr);
  const hid_t set = H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, v.data());
  if (*unit) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, std::string(unit).size());
    const hid_t one = H5Screate(H5S_SCALAR), attribute = H5Acreate2(set, "unit", type, one, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, type, unit);
    H5Aclose(attribute), H5Sclose(one), H5Tclose(type);
  }
  H5Dclose(set), H5Sclose(space);
}

// The same table as text and as HDF5.
std::pair<std::string, std::string> tables(const std::string& called) {
  const std::string csv = ::testing::TempDir() + called + ".csv", h5 = ::testing::TempDir() + called + ".h5";
  std::ofstream text(csv);
  text.precision(17);
  text << "time [s], hip [deg], x [m], y [m], z [m], qw, qx, qy, qz\n";
  std::vector<double> time, hip, pose;
  for (int i = 0; i < kRows; ++i) {
    // Every second quaternion on the other side: the same turns.
    Eigen::Quaterniond q = turn_at(i);
    if (i % 2) q.coeffs() *= -1;
    const Vec3 p = place_at(i);
    text << time_at(i) << ", " << angle_at(i) << ", " << p[0] << ", " << p[1] << ", " << p[2] << ", " << q.w() << ", " << q.x() << ", " << q.y()
         << ", " << q.z() << "\n";
    time.push_back(time_at(i)), hip.push_back(angle_at(i));
    for (double v : {p[0], p[1], p[2], q.w(), q.x(), q.y(), q.z()}) pose.push_back(v);
  }
  const hid_t file = H5Fcreate(h5.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
              group = H5Gcreate2(file, "walk", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  write(file, "time", time, 1, "s"), write(group, "hip", hip, 1, "deg"), write(group, "pose", pose, 7, "m");
  H5Gclose(group), H5Fclose(file);
  return {csv, h5};
}

std::string on_track(const std::string& drive, const std::string& motion) {
  return R"(
mortise: 1
name: track
time: {step: 4 ms, steps: 100}
materials: {steel: {density: 1000}}
bodies:
  palm: {type: stiff, shape: {box: {size: [60 mm, 40 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [100 mm, 0, 50 mm]}
  arm: {type: stiff, shape: {box: {size: [100 mm, 20 mm, 20 mm], edge_length: 100 mm}}, material: steel, position: [150 mm, 0, 50 mm]}
effects:
  inertia: {}
  affine_body: {}
  pin: [{body: palm, where: {side: all}, motion: {file: {)" +
         motion + R"(}}}]
  joint: [{name: hip, type: revolute, body: arm, to: palm, at: [100 mm, 0, 50 mm], axis: [0, 1, 0]}]
  drive: [{joint: hip, mode: pd, kp: 5, kd: 0.05, file: {)" +
         drive + "}}]\n";
}

}  // namespace

TEST(Trajectories, FromTextAndHdf5AreTheSame) {
  scene::set_column_reader(output::read_column);
  const auto [csv, h5] = tables("mortise_track");
  Rig text(on_track("path: " + csv + ", column: hip", "path: " + csv + ", position: [x, y, z], quaternion: [qw, qx, qy, qz]"));
  Rig binary(on_track("path: " + h5 + ", column: walk/hip",
                      "path: " + h5 +
                          ", position: ['walk/pose[0]', 'walk/pose[1]', 'walk/pose[2]'], quaternion: ['walk/pose[3]', 'walk/pose[4]', "
                          "'walk/pose[5]', 'walk/pose[6]']"));
  // By a rate, which makes 100 rows per second.
  Rig rate(on_track("path: " + h5 + ", column: walk/hip, rate: 100", "path: " + csv + ", position: [x, y, z], quaternion: [qw, qx, qy, qz]"));
  EXPECT_FALSE(binary.scene.root.at("effects").at("drive").items()[0].has("file"));
  const std::vector<double> start = text.engine->points();
  for (int n = 1; n <= 50; ++n) {
    text.step(), binary.step(), rate.step();
    ASSERT_EQ(text.engine->points(), binary.engine->points()) << n;
    EXPECT_EQ(text.fields().at("drive/hip_target"), binary.fields().at("drive/hip_target"));
    EXPECT_NEAR(text.fields().at("drive/hip_target"), rate.fields().at("drive/hip_target"), 1e-12);
    if (n % 5 != 0) continue;  // the times of keys
    const int key = 2 * n / 5;
    EXPECT_NEAR(text.fields().at("drive/hip_target"), angle_at(key) * M_PI / 180, 1e-12);
    // The palm has eight corners, the first of all points: each is at p + R R_0^T (X - p_0).
    const Mat3 R = (turn_at(key) * turn_at(0).conjugate()).toRotationMatrix();
    const std::vector<double> now = text.engine->points();
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 X(start[3 * corner], start[3 * corner + 1], start[3 * corner + 2]), x(now[3 * corner], now[3 * corner + 1], now[3 * corner + 2]);
      EXPECT_LT((x - (place_at(key) + R * (X - place_at(0)))).norm(), 1e-12) << key;
    }
  }
  // The resolved scene is the same scene, without the files.
  const std::string again = scene::to_yaml(binary.scene.root);
  EXPECT_EQ(again.find(".h5"), std::string::npos);
  Rig same(again);
  same.steps(50);
  EXPECT_EQ(same.engine->points(), binary.engine->points());
}

// Quaternions as keys of the scene are the turn about one axis that `rotation` says, halfway too and whichever side they are on.
TEST(Trajectories, OrientationIsARotation) {
  const auto with = [](const std::string& motion) {
    std::string yaml = on_track("path: none", "none: 0");
    yaml.replace(yaml.find("motion: {file: {none: 0}}"), 25, "motion: {time: [0, 0.1, 0.2], interpolation: smooth, " + motion + "}");
    yaml.erase(yaml.find("  drive:"));
    return yaml;
  };
  const double a = 0.5, b = 0.1;
  std::string w, z;
  for (double angle : {0.0, a, b}) {
    const int side = angle == a ? -1 : 1;
    w += fmt::format("{}{:.17g}", w.empty() ? "" : ", ", side * std::cos(angle / 2)),
        z += fmt::format("{}{:.17g}", z.empty() ? "" : ", ", side * std::sin(angle / 2));
  }
  Rig turned(with("rotation: {axis: [0, 0, 1], centre: [50 mm, 0, 0], angle: [0, 0.5, 0.1]}"));
  Rig oriented(with("orientation: {centre: [50 mm, 0, 0], w: [" + w + "], x: [0, 0, 0], y: [0, 0, 0], z: [" + z + "]}"));
  for (int n = 1; n <= 50; ++n) {
    turned.step(), oriented.step();
    const std::vector<double> x = turned.engine->points(), y = oriented.engine->points();
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], y[i], 1e-12) << n;
  }
}

TEST(Trajectories, Refusals) {
  scene::set_column_reader(output::read_column);
  const auto refused = [](const std::string& yaml) {
    try {
      Rig rig(yaml);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("nothing");
  };
  const auto [csv, h5] = tables("mortise_track_refused");
  const std::string drive = "path: " + csv + ", column: hip", motion = "path: " + csv + ", position: [x, y, z]";
  const auto says = [](const std::string& message, const std::string& text) { EXPECT_NE(message.find(text), std::string::npos) << message; };
  says(refused(on_track(drive, "path: " + csv + ", position: [x, y, hip]")), "'deg' is no unit of length; there are: m, mm");
  says(refused(on_track(drive, "path: " + csv + ", position: [x, y, q]")), "has no column 'q'");
  says(refused(on_track(drive, motion + ", quaternion: [qx, qw, qy, z]")), "has the norm");
  says(refused(on_track(drive, motion + ", unit: mm")), "unit is mm, but");
  says(refused(on_track("path: " + h5 + ", column: walk/pose", motion)), "'walk/pose' has 7 columns: say which");
  says(refused(on_track("path: " + h5 + ", column: 'walk/pose[0]'", motion)), "travel has no meaning");  // metres, of a hinge
}
