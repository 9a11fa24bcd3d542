#include "output/field_file.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "helpers.h"
#include "output/field_reader.h"

namespace mortise::output {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::int64_t> integers(const h5::File& f, const std::string& folder, const std::string& name) {
  const h5::Table t = h5::Table::open(f, h5::open_group(f, f.id(), folder), name);
  return t.read<std::int64_t>(f, 0, t.rows());
}

StepRow step_row(int i) {
  StepRow row;
  row.step = i, row.time = 0.01 * i, row.dt = 0.01, row.newton_iterations = i + 2, row.residual = 1e-9 * i;
  return row;
}

// Frame f: "velocity" always, "pressure" from frame 1 on, "stress" (cells) not in frame 1, rows of changing number.
void write_frame(FieldFile& file, const OutputMesh& mesh, int f) {
  file.append_step(step_row(2 * f));
  file.append_step(step_row(2 * f + 1));
  file.begin_frame(0.1 * f, flat(mesh, f));
  file.points("velocity", "m/s", 3, ramp(3 * mesh.points.size(), f));
  if (f >= 1) file.points("pressure", "Pa", 1, ramp(mesh.points.size(), 1000 * f));
  if (f != 1) file.cells("stress", "Pa", 9, ramp(9 * mesh.cells(), -f));
  if (f != 2) file.rows("barrier_contact", "position", "m", 3, ramp(3 * (f * 5), f));
  file.rows("barrier_contact", "gap", "m", 1, ramp(7 - f, 10 * f));
  if (f != 0) file.scalar("friction", "work", "J", 0.125 * f);
  file.end_frame();
}

void write_run(const std::string& path, int frames, const FieldOptions& options = {}) {
  const OutputMesh mesh = small_mesh();
  auto file = FieldFile::open(path, mesh, small_info(), options);
  for (int f = 0; f < frames; ++f) write_frame(*file, mesh, f);
  file->close();
}

// Environments in one model write a file each: the bytes of all are those of one alone, and no dataset stays open between frames, or every write of
// one file would take time in proportion to what is open in all.
TEST(FieldFile, ManyAtOnceKeepNoDatasetsOpen) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  const auto datasets = [] { return H5Fget_obj_count(H5F_OBJ_ALL, H5F_OBJ_DATASET); };
  constexpr int kFrames = 4;
  write_run(dir / "alone.vtkhdf", kFrames);
  std::vector<std::unique_ptr<FieldFile>> many;
  for (int k = 0; k < 20; ++k) many.push_back(FieldFile::open(dir / (std::to_string(k) + ".vtkhdf"), mesh, small_info(), {}));
  for (int f = 0; f < kFrames; ++f) {
    for (auto& file : many) write_frame(*file, mesh, f);
    EXPECT_EQ(datasets(), 0) << f;
  }
  many.back().reset();  // a run that ends
  many.back() = FieldFile::reopen(dir / "19.vtkhdf", kFrames - 1, 2 * (kFrames - 1), {});
  write_frame(*many.back(), mesh, kFrames - 1);
  EXPECT_EQ(datasets(), 0);
  for (auto& file : many) file->close();
  many.clear();
  const FieldReader alone(dir / "alone.vtkhdf");
  for (int k = 0; k < 20; ++k) {
    const FieldReader reader(dir / (std::to_string(k) + ".vtkhdf"));
    ASSERT_EQ(reader.frames(), kFrames);
    for (int f = 0; f < kFrames; ++f) {
      EXPECT_EQ(reader.points(f), alone.points(f));
      EXPECT_EQ(reader.point_field("velocity", f).values, alone.point_field("velocity", f).values);
      EXPECT_EQ(reader.rows("barrier_contact", "gap", f).values, alone.rows("barrier_contact", "gap", f).values);
      if (f > 0) EXPECT_EQ(reader.scalar("friction", "work", f).values, alone.scalar("friction", "work", f).values);
    }
  }
  // A few keep theirs, which is quicker.
  auto one = FieldFile::open(dir / "one.vtkhdf", mesh, small_info(), {});
  write_frame(*one, mesh, 0);
  EXPECT_GT(datasets(), 20);
  one->close();
}

// Frames that share a commit leave the same bytes; before it there is no trace of them.
TEST(FieldFile, FramesCanShareACommit) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  const auto bytes = [](const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  };
  const std::string once = dir / "once.vtkhdf";
  auto file = FieldFile::open(once, mesh, small_info(), {.commit_seconds = 1e9});
  for (int f = 0; f < 5; ++f) write_frame(*file, mesh, f);
  EXPECT_EQ(FieldReader(once).frames(), 0);
  file->flush();
  EXPECT_EQ(FieldReader(once).frames(), 5);
  for (int f = 5; f < 7; ++f) write_frame(*file, mesh, f);
  file.reset();  // as after a kill
  EXPECT_EQ(FieldReader(once).frames(), 5);
  file = FieldFile::reopen(once, 5, 10, {.commit_seconds = 1e9});
  for (int f = 5; f < 7; ++f) write_frame(*file, mesh, f);
  file->close();
  const FieldReader whole(once);
  EXPECT_EQ(whole.frames(), 7);
  for (int f = 0; f < 7; ++f) expect_f32(whole.point_field("velocity", f).values, ramp(24, f));

  const std::string each = dir / "each.vtkhdf", all = dir / "all.vtkhdf";
  const auto date = [](const std::string& path) {
    const h5::File f(path, h5::Mode::read);
    return h5::get_text(f, f.id(), "date_and_time");
  };
  do {  // the second in which it was made, and checksums of it, must not differ
    for (const std::string& path : {each, all}) {
      file = FieldFile::open(path, mesh, {"0.1.0", "x", "scene", std::string(64, 'a')}, {.commit_seconds = path == all ? 1e9 : 0});
      for (int f = 0; f < 5; ++f) write_frame(*file, mesh, f);
      file->close();
    }
  } while (date(each) != date(all));
  EXPECT_TRUE(bytes(each) == bytes(all));
}

TEST(FieldFile, NoObjectKeepsTheSecondInWhichItWasMade) {  // or equal runs would give equal bytes only within a second
  Folder dir;
  write_run(dir / "fields.vtkhdf", 3);
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  std::vector<std::string> dated;
  const auto look = [](hid_t, const char* name, const auto* info, void* found) -> herr_t {
    if (info->mtime != 0 || info->ctime != 0) static_cast<std::vector<std::string>*>(found)->emplace_back(name);
    return 0;
  };
  ASSERT_GE(H5Ovisit2(f.id(), H5_INDEX_NAME, H5_ITER_INC, look, &dated, H5O_INFO_TIME), 0);
  EXPECT_THAT(dated, IsEmpty());
}

TEST(FieldFile, StructureIsTemporalVtkHdf) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 3);
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  EXPECT_EQ(h5::get_text(f, f.id(), "filetype"), "mortise fields");
  EXPECT_THAT(h5::get_integers(f, f.id(), "version"), ElementsAre(1, 0));
  EXPECT_EQ(h5::get_text(f, f.id(), "mortise_version"), "0.1.0");
  EXPECT_EQ(h5::get_text(f, f.id(), "git_sha1"), "0123abc");
  EXPECT_EQ(h5::get_text(f, f.id(), "scene_sha256"), std::string(64, 'a'));
  EXPECT_EQ(h5::get_text(f, f.id(), "date_and_time").size(), 20u);
  const h5::Id root = h5::open_group(f, f.id(), "VTKHDF");
  EXPECT_THAT(h5::get_integers(f, root, "Version"), ElementsAre(2, 2));
  const h5::Id type_attribute(H5Aopen(root, "Type", H5P_DEFAULT));
  const h5::Id type(H5Aget_type(type_attribute));
  EXPECT_EQ(H5Tis_variable_str(type), 0);
  EXPECT_EQ(H5Tget_cset(type), H5T_CSET_ASCII);
  EXPECT_EQ(H5Tget_size(type), std::string("UnstructuredGrid").size());
  EXPECT_EQ(h5::get_integer(f, h5::open_group(f, root, "Steps"), "NSteps"), 3);
  const std::string s = "VTKHDF/Steps";
  EXPECT_THAT(integers(f, s, "NumberOfParts"), ElementsAre(1, 1, 1));
  EXPECT_THAT(integers(f, s, "PartOffsets"), ElementsAre(0, 0, 0));
  EXPECT_THAT(integers(f, s, "PointOffsets"), ElementsAre(0, 8, 16));
  EXPECT_THAT(integers(f, s, "CellOffsets"), ElementsAre(0, 0, 0));
  EXPECT_THAT(integers(f, s, "ConnectivityIdOffsets"), ElementsAre(0, 0, 0));
  EXPECT_THAT(integers(f, s + "/PointDataOffsets", "velocity"), ElementsAre(0, 8, 16));
  EXPECT_THAT(integers(f, s + "/PointDataOffsets", "pressure"), ElementsAre(0, 8, 16));
  EXPECT_THAT(integers(f, s + "/PointDataOffsets", "body_id"), ElementsAre(0, 0, 0));
  EXPECT_THAT(integers(f, s + "/CellDataOffsets", "stress"), ElementsAre(0, 3, 6));
  EXPECT_THAT(integers(f, s + "/CellDataOffsets", "body_id"), ElementsAre(0, 0, 0));
  EXPECT_THAT(integers(f, "VTKHDF", "Connectivity"), ElementsAre(0, 1, 2, 3, 4, 5, 6, 4, 6, 7));
  EXPECT_THAT(integers(f, "VTKHDF", "Offsets"), ElementsAre(0, 4, 7, 10));
  EXPECT_THAT(integers(f, "VTKHDF", "NumberOfPoints"), ElementsAre(8));
  EXPECT_THAT(integers(f, "VTKHDF", "NumberOfCells"), ElementsAre(3));
  EXPECT_THAT(integers(f, "VTKHDF", "NumberOfConnectivityIds"), ElementsAre(10));
}

// Every dataset of the file says its unit.
herr_t check_unit(hid_t parent, const char* name, const H5O_info_t* info, void* count) {
  if (info->type == H5O_TYPE_DATASET) {
    ++*static_cast<int*>(count);
    EXPECT_GT(H5Aexists_by_name(parent, name, "unit", H5P_DEFAULT), 0) << name;
  }
  return 0;
}

TEST(FieldFile, EveryDatasetHasAUnit) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 2);
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  int datasets = 0;
  H5Ovisit2(f.id(), H5_INDEX_NAME, H5_ITER_INC, check_unit, &datasets, H5O_INFO_BASIC);
  EXPECT_GT(datasets, 40);
  EXPECT_EQ(h5::Table::open(f, h5::open_group(f, f.id(), "VTKHDF"), "Points").unit(f), "m");
  EXPECT_EQ(h5::Table::open(f, h5::open_group(f, f.id(), "VTKHDF/Steps"), "Values").unit(f), "s");
  EXPECT_EQ(h5::Table::open(f, h5::open_group(f, f.id(), "mortise/effects/friction"), "work").unit(f), "J");
  EXPECT_EQ(h5::Table::open(f, h5::open_group(f, f.id(), "mortise/steps"), "residual").unit(f), "N");
}

TEST(FieldFile, ChunkIsOneFrameOfOneField) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 1);
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  const h5::Table t = h5::Table::open(f, h5::open_group(f, f.id(), "VTKHDF/PointData"), "velocity");
  const h5::Id layout(H5Dget_create_plist(t.id()));
  hsize_t chunk[2] = {};
  ASSERT_EQ(H5Pget_chunk(layout, 2, chunk), 2);
  EXPECT_THAT(chunk, ElementsAre(8, 3));
  ASSERT_EQ(H5Pget_nfilters(layout), 2);
  unsigned flags = 0, level = 0;
  std::size_t n = 1;
  EXPECT_EQ(H5Pget_filter2(layout, 0, &flags, nullptr, nullptr, 0, nullptr, nullptr), H5Z_FILTER_SHUFFLE);
  EXPECT_EQ(H5Pget_filter2(layout, 1, &flags, &n, &level, 0, nullptr, nullptr), H5Z_FILTER_DEFLATE);
  EXPECT_EQ(level, 1u);
  EXPECT_TRUE(t.single());
}

TEST(FieldFile, ReadsBackWhatWasWritten) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  write_run(dir / "fields.vtkhdf", 4);
  const FieldReader r(dir / "fields.vtkhdf");
  ASSERT_EQ(r.frames(), 4);
  EXPECT_EQ(r.scene_text(), small_info().scene_text);
  EXPECT_EQ(r.mesh().points, mesh.points);
  EXPECT_EQ(r.mesh().connectivity, mesh.connectivity);
  EXPECT_EQ(r.mesh().offsets, mesh.offsets);
  EXPECT_EQ(r.mesh().types, mesh.types);
  EXPECT_EQ(r.mesh().body_of_cell, mesh.body_of_cell);
  EXPECT_EQ(r.mesh().body_of_point, mesh.body_of_point);
  EXPECT_EQ(r.mesh().body_names, mesh.body_names);
  EXPECT_THAT(r.point_fields(), ElementsAre("body_id", "pressure", "velocity"));
  for (int f = 0; f < 4; ++f) {
    EXPECT_EQ(r.time(f), 0.1 * f);
    std::vector<double> xyz;
    for (const Vec3& x : r.points(f)) xyz.insert(xyz.end(), x.data(), x.data() + 3);
    expect_f32(xyz, flat(mesh, f));
    const FieldValues v = r.point_field("velocity", f);
    EXPECT_EQ(v.unit, "m/s");
    EXPECT_EQ(v.components, 3);
    expect_f32(v.values, ramp(24, f));
    EXPECT_THAT(r.cell_field("body_id", f).values, ElementsAre(0, 1, 1));
  }
  const auto steps = r.steps();
  ASSERT_EQ(steps.size(), 8u);
  EXPECT_EQ(steps[5].time, 0.05);
  EXPECT_EQ(steps[5].newton_iterations, 7);
  EXPECT_TRUE(std::isnan(steps[5].energy));
  EXPECT_EQ(r.point_field("no_such_field", 0).components, 0);
  EXPECT_THAT(file_error([&] { r.points(4); }), HasSubstr("no frame 4"));
}

TEST(FieldFile, MissingFieldIsNotANumberInThatFrameOnly) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 3);
  const FieldReader r(dir / "fields.vtkhdf");
  for (double v : r.point_field("pressure", 0).values) EXPECT_TRUE(std::isnan(v));
  expect_f32(r.point_field("pressure", 1).values, ramp(8, 1000));
  expect_f32(r.point_field("pressure", 2).values, ramp(8, 2000));
  expect_f32(r.cell_field("stress", 0).values, ramp(27, 0));
  EXPECT_EQ(r.cell_field("stress", 1).values.size(), 27u);
  for (double v : r.cell_field("stress", 1).values) EXPECT_TRUE(std::isnan(v));
  expect_f32(r.cell_field("stress", 2).values, ramp(27, -2));
  EXPECT_TRUE(std::isnan(r.scalar("friction", "work", 0).values.at(0)));
  EXPECT_EQ(r.scalar("friction", "work", 2).values.at(0), 0.25);
}

TEST(FieldFile, FieldMissingInTheLastFrameHasItsBlock) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 2);
  const FieldReader r(dir / "fields.vtkhdf");
  EXPECT_EQ(r.cell_field("stress", 1).values.size(), 27u);
}

TEST(FieldFile, LateFieldHasABlockInEveryFrameBefore) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {});
  for (int f = 0; f < 4; ++f) {
    file->begin_frame(f, flat(mesh, f));
    if (f == 3) file->points("late", "1", 1, ramp(8, 0));
    file->end_frame();
  }
  file->close();
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  EXPECT_THAT(integers(f, "VTKHDF/Steps/PointDataOffsets", "late"), ElementsAre(0, 8, 16, 24));
  EXPECT_TRUE(std::isnan(FieldReader(dir / "fields.vtkhdf").point_field("late", 2).values.at(7)));
}

TEST(FieldFile, ReopeningDropsWhatComesAfter) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 4);
  FieldFile::reopen(dir / "fields.vtkhdf", 2, 5, {})->close();
  const FieldReader r(dir / "fields.vtkhdf");
  EXPECT_EQ(r.frames(), 2);
  EXPECT_EQ(r.steps().size(), 5u);
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  EXPECT_EQ(h5::Table::open(f, h5::open_group(f, f.id(), "VTKHDF"), "Points").rows(), 16u);
  EXPECT_EQ(h5::Table::open(f, h5::open_group(f, f.id(), "mortise/effects/barrier_contact"), "position").rows(), 5u);
}

TEST(FieldFile, RaggedRowsKeepTheirFrames) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 4);
  const FieldReader r(dir / "fields.vtkhdf");
  EXPECT_EQ(r.rows("barrier_contact", "position", 0).values.size(), 0u);
  expect_f32(r.rows("barrier_contact", "position", 1).values, ramp(15, 1));
  EXPECT_EQ(r.rows("barrier_contact", "position", 2).values.size(), 0u);  // not reported
  expect_f32(r.rows("barrier_contact", "position", 3).values, ramp(45, 3));
  for (int f = 0; f < 4; ++f) expect_f32(r.rows("barrier_contact", "gap", f).values, ramp(7 - f, 10 * f));
  EXPECT_EQ(r.rows("barrier_contact", "position", 1).unit, "m");
  const h5::File f(dir / "fields.vtkhdf", h5::Mode::read);
  EXPECT_THAT(integers(f, "mortise/effects/barrier_contact/row_offset", "position"), ElementsAre(0, 0, 5, 5, 20));
}

TEST(FieldFile, DoublePrecisionIsExact) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 2, {.double_precision = true});
  const FieldReader r(dir / "fields.vtkhdf");
  EXPECT_EQ(r.point_field("velocity", 1).values, ramp(24, 1));
  EXPECT_EQ(r.rows("barrier_contact", "gap", 1).values, ramp(6, 10));
}

TEST(FieldFile, KeepsOnlyTheFieldsAskedFor) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 2, {.fields = {"pressure"}});
  const FieldReader r(dir / "fields.vtkhdf");
  EXPECT_THAT(r.point_fields(), ElementsAre("body_id", "pressure"));
  EXPECT_THAT(r.cell_fields(), ElementsAre("body_id"));
  EXPECT_EQ(r.rows("barrier_contact", "gap", 0).components, 1);
}

TEST(FieldFile, ReopenedRunEqualsUnbrokenRun) {
  Folder dir;
  write_run(dir / "whole.vtkhdf", 5);
  {
    const OutputMesh mesh = small_mesh();
    write_run(dir / "broken.vtkhdf", 4);
    auto file = FieldFile::reopen(dir / "broken.vtkhdf", 2, 4, {});
    EXPECT_EQ(file->frames(), 2);
    for (int f = 2; f < 5; ++f) write_frame(*file, mesh, f);
    file->close();
  }
  const FieldReader a(dir / "whole.vtkhdf"), b(dir / "broken.vtkhdf");
  ASSERT_EQ(b.frames(), 5);
  EXPECT_EQ(a.times(), b.times());
  ASSERT_EQ(b.steps().size(), 10u);
  EXPECT_EQ(b.steps()[9].step, 9);
  const auto same = [](const FieldValues& x, const FieldValues& y) {
    ASSERT_EQ(x.values.size(), y.values.size());
    EXPECT_EQ(x.unit, y.unit);
    for (std::size_t i = 0; i < x.values.size(); ++i) {
      EXPECT_TRUE(x.values[i] == y.values[i] || (std::isnan(x.values[i]) && std::isnan(y.values[i])));
    }
  };
  for (int f = 0; f < 5; ++f) {
    EXPECT_EQ(a.points(f), b.points(f));
    same(a.point_field("velocity", f), b.point_field("velocity", f));
    same(a.point_field("pressure", f), b.point_field("pressure", f));
    same(a.cell_field("stress", f), b.cell_field("stress", f));
    same(a.rows("barrier_contact", "position", f), b.rows("barrier_contact", "position", f));
    same(a.rows("barrier_contact", "gap", f), b.rows("barrier_contact", "gap", f));
    same(a.scalar("friction", "work", f), b.scalar("friction", "work", f));
  }
  std::stringstream x, y;
  x << std::ifstream(dir / "whole.xdmf").rdbuf();
  y << std::ifstream(dir / "broken.xdmf").rdbuf();
  std::string text = y.str();
  for (std::size_t at; (at = text.find("broken.vtkhdf")) != std::string::npos;) text.replace(at, 13, "whole.vtkhdf");
  EXPECT_EQ(x.str(), text);
}

TEST(FieldFile, CannotContinueBeyondItsEnd) {
  Folder dir;
  write_run(dir / "fields.vtkhdf", 2);
  EXPECT_THAT(file_error([&] { FieldFile::reopen(dir / "fields.vtkhdf", 3, 4, {}); }), HasSubstr("the file holds 2"));
  EXPECT_THAT(file_error([&] { FieldFile::reopen(dir / "fields.vtkhdf", 2, 5, {}); }), HasSubstr("the file holds 4"));
  EXPECT_EQ(FieldReader(dir / "fields.vtkhdf").frames(), 2);
}

TEST(FieldFile, MisuseIsReported) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {});
  const auto misuse = [](auto&& f) {
    try {
      f();
    } catch (const Error& e) {
      return e.code() == Exit::internal;
    }
    return false;
  };
  EXPECT_TRUE(misuse([&] { file->points("p", "Pa", 1, ramp(8, 0)); }));
  file->begin_frame(0, flat(mesh, 0));
  EXPECT_TRUE(misuse([&] { file->points("p", "Pa", 1, ramp(7, 0)); }));
  EXPECT_TRUE(misuse([&] { file->points("a/b", "Pa", 1, ramp(8, 0)); }));
  file->points("p", "Pa", 1, ramp(8, 0));
  EXPECT_TRUE(misuse([&] { file->points("p", "Pa", 1, ramp(8, 0)); }));
  file->rows("g", "r", "1", 1, ramp(3, 0));
  EXPECT_TRUE(misuse([&] { file->scalar("g", "r", "1", 0); }));
  file->end_frame();
  file->close();
  EXPECT_EQ(FieldReader(dir / "fields.vtkhdf").frames(), 1);
}

TEST(FieldFile, GrowingFileIsReadableInTheSameProcess) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {});
  write_frame(*file, mesh, 0);
  EXPECT_EQ(FieldReader(dir / "fields.vtkhdf").frames(), 1);
  write_frame(*file, mesh, 1);
  const FieldReader r(dir / "fields.vtkhdf");
  EXPECT_EQ(r.frames(), 2);
  expect_f32(r.point_field("velocity", 1).values, ramp(24, 1));
}

TEST(FieldReader, RefusesOtherFiles) {
  Folder dir;
  std::ofstream(dir / "text") << "hello";
  EXPECT_EQ(file_error([&] { FieldReader(dir / "text"); }), (dir / "text") + ": cannot open: not an HDF5 file");
  EXPECT_EQ(file_error([&] { FieldReader(dir / "none"); }), (dir / "none") + ": cannot open: No such file or directory");
  h5::File(dir / "other.h5", h5::Mode::create).close();
  EXPECT_THAT(file_error([&] { FieldReader(dir / "other.h5"); }), HasSubstr("not a mortise field file"));
}

}  // namespace
}  // namespace mortise::output
