// H59, H60: the overlaps of a master mesh must fill a face of the slave, whatever the two meshes do to each other: coincide, differ by less
// than rounding shows, cross at small angles, or be a hundred times finer.
#include <fmt/format.h>

#include <numeric>

#include "bench/all.h"
#include "bench/meshes.h"

namespace mortise::bench {
namespace {

struct Case {
  std::string name;
  int slave, master;  // cells along the unit square
  double shift = 0;   // of the master, in slave cells along x and half as much along y
  double turn = 0;    // of the master about the middle of the face [rad]
};

std::vector<Case> cases(int ratio) {
  std::vector<Case> all{{"coincident", 6, 6}};
  for (const double s : {1e-16, 1e-12, 1e-9, 1e-6, 0.3}) all.push_back({fmt::format("shifted by {:g} h", s), 6, 6, s});
  for (const double t : {1e-12, 1e-6, 1e-2, 0.5}) all.push_back({fmt::format("turned by {:g}", t), 6, 6, 0, t});
  all.push_back({fmt::format("slave 1, master {} cells", ratio), 1, ratio, 0.01});
  all.push_back({fmt::format("slave {}, master 1 cell", ratio), ratio, 1, 0.1});
  return all;
}

// The master's cells continue beyond the slave's face, so that all of it is covered.
geometry::TetMesh master_mesh(const Case& c, double gap) {
  const double h = 1.0 / c.master;
  const int margin = 1 + static_cast<int>(std::ceil((c.shift / c.slave + 0.6 * std::sin(c.turn)) / h));  // cells
  const double out = margin * h;
  geometry::TetMesh mesh =
      jittered_block(Vec3(-out, -out, gap), Vec3(1 + out, 1 + out, gap + 0.5), {c.master + 2 * margin, c.master + 2 * margin, 1}, 0, 1);
  const Mat3 R = Eigen::AngleAxisd(c.turn, Vec3::UnitZ()).toRotationMatrix();
  const Vec3 middle(0.5, 0.5, 0), shift(c.shift / c.slave, 0.5 * c.shift / c.slave, 0);
  for (Vec3& x : mesh.points) x = middle + R * (x - middle) + shift;
  return mesh;
}

}  // namespace

void partition(const Bench& b) {
  const double gap = 0.5 * b.scene().number("effects.mortar_contact.d_hat");
  for (const Case& c : cases(b.count("ratio", 25)))
    for (const Method& m : b.methods()) {
      if (m.effect != "mortar_contact") continue;  // the others have no overlaps
      SceneText scene = b.scene();
      scene.use(m, 1);
      const Solved s = solve(scene, [&](model::ModelInput& input) {
        set_mesh(input, "below", jittered_block(Vec3(0, 0, -0.5), Vec3(1, 1, 0), {c.slave, c.slave, 1}, 0, 1));
        set_mesh(input, "above", master_mesh(c, gap));
      });
      const auto area = s.fields.row.find("mortar_contact/area");
      const double sum = area == s.fields.row.end() ? NAN : std::accumulate(area->second.begin(), area->second.end(), 0.0);
      const double gate = m.gated ? 1e-12 : NAN;
      b.emit(s.row(c.name, m, "area of all samples", sum, 1, std::abs(sum - 1), gate));
      const double defect = s.fields.at("mortar_contact/clip_partition_defect");
      b.emit(s.row(c.name, m, "worst triangle", 1 + defect, 1, defect, gate));
    }
}

}  // namespace mortise::bench
