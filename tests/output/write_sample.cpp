// Writes a small run into the folder named on the command line, for tests/output/read_with_vtk.py:
// records of runs, and field files of 7 frames, fields that come late or stay away in a frame, rows of changing number, several cell
// types.
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "geometry/quadratic.h"
#include "output/field_file.h"
#include "output/run_json.h"

using namespace mortise;
using namespace mortise::output;

namespace {

// Wave-like values; the Python side computes the same: sin(i + 10 f) * scale.
std::vector<double> wave(std::size_t n, int f, double scale) {
  std::vector<double> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = scale * std::sin(static_cast<double>(i) + 10.0 * f);
  return out;
}

// `tets` tetrahedra and `quadratic` ones side by side, then, if asked, two triangles.
OutputMesh mesh_of(int tets, int quadratic, bool triangles) {
  OutputMesh m;
  m.offsets = {0};
  const auto cell = [&](std::uint8_t type, int body, const std::vector<Vec3>& corners) {
    for (const Vec3& x : corners) {
      m.connectivity.push_back(static_cast<std::int64_t>(m.points.size()));
      m.points.push_back(x);
      m.body_of_point.push_back(body);
    }
    m.types.push_back(type);
    m.body_of_cell.push_back(body);
    m.offsets.push_back(static_cast<std::int64_t>(m.connectivity.size()));
  };
  for (int i = 0; i < tets; ++i) {
    const Vec3 o(0.01 * i, 0, 0);
    cell(tetrahedron, 0, {o, o + Vec3(0.01, 0, 0), o + Vec3(0, 0.01, 0), o + Vec3(0, 0, 0.01)});
  }
  for (int i = 0; i < quadratic; ++i) {
    std::vector<Vec3> x{Vec3(0.01 * i, 0, 0.1), Vec3(0.01 * i + 0.01, 0, 0.1), Vec3(0.01 * i, 0.01, 0.1), Vec3(0.01 * i, 0, 0.11)};
    for (int e = 0; e < 6; ++e) x.push_back(0.5 * (x[geometry::edge_begin(e)] + x[geometry::edge_end(e)]));
    cell(quadratic_tetrahedron, 0, x);
  }
  m.body_names = {"pad"};
  if (triangles) {
    cell(triangle, 1, {Vec3(0, 0, 0.02), Vec3(0.01, 0, 0.02), Vec3(0, 0.01, 0.02)});
    cell(triangle, 1, {Vec3(0, 0, 0.03), Vec3(0.01, 0, 0.03), Vec3(0, 0.01, 0.03)});
    m.body_names.push_back("tool");
  }
  return m;
}

void write_record(const std::string& path, Exit code) {
  RunRecord r;
  r.exit_code = code;
  r.message = code == Exit::done ? "" : "why";
  r.mortise_version = "0.1.0";
  r.libraries["hdf5"] = "1.10.8";
  r.hardware = hardware();
  r.device = {"cpu", "cpu", 2, 0, "", "", ""};
  r.scene_sha256 = std::string(64, '0');
  r.seconds["output"] = 1;
  r.phases = {{"solver", "solve", 0.5, 3}};
  r.launches = {{"inertia.energy", 3}};
  r.steps = {StepRow{.step = 1, .residual = 1e-9}};
  write_run_json(path, r);
}

void write_run(const std::string& path, const OutputMesh& mesh, bool double_precision, int frames) {
  FieldOptions options;
  options.double_precision = double_precision;
  const auto file = FieldFile::open(path, mesh, {"0.1.0", "test", "mortise: 1\n", "none"}, options);
  const std::size_t n = mesh.points.size(), c = mesh.cells();
  for (int f = 0; f < frames; ++f) {
    std::vector<double> x;
    for (const Vec3& p : mesh.points) x.insert(x.end(), {p[0], p[1], p[2] + 0.001 * f});
    file->append_step({.step = f + 1.0, .time = 0.05 * f});
    file->begin_frame(0.05 * f, x);
    file->points("velocity", "m/s", 3, wave(3 * n, f, 1));
    if (f >= 2) file->points("contact_pressure", "Pa", 1, wave(n, f, 1000));
    if (f != 3) file->cells("stress", "Pa", 9, wave(9 * c, f, 1e5));
    file->rows("barrier_contact", "gap", "m", 1, wave(static_cast<std::size_t>(f % 3), f, 1));
    file->scalar("friction", "work", "J", 0.5 * f);
    file->end_frame();
  }
  file->close();
}

}  // namespace

int main(int, char** argv) {
  try {
    const std::string dir = argv[1];
    write_record(dir + "/run.json", Exit::done);
    write_record(dir + "/failed.json", Exit::solve);
    write_run(dir + "/mixed.vtkhdf", mesh_of(5, 2, true), false, 7);
    write_run(dir + "/tets.vtkhdf", mesh_of(9, 0, false), true, 7);
    write_run(dir + "/quadratic.vtkhdf", mesh_of(0, 3, false), true, 7);
    // A run killed after frame 4: the frames before must be readable as they are.
    const OutputMesh mesh = mesh_of(5, 0, true);
    write_run(dir + "/killed.vtkhdf", mesh, false, 4);
    const auto file = FieldFile::reopen(dir + "/killed.vtkhdf", 4, 4, {});
    file->begin_frame(1, std::vector<double>(3 * mesh.points.size(), 1.0));
    file->points("velocity", "m/s", 3, wave(3 * mesh.points.size(), 9, 1));
    std::_Exit(0);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
