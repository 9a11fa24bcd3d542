// What is left of a field file when the process is killed or the disk is full.
#include <gmock/gmock.h>

#include <fstream>

#include "helpers.h"
#include "output/field_reader.h"

namespace mortise::output {
namespace {

using testing::HasSubstr;

OutputMesh cloud(int n) {
  OutputMesh m;
  for (int i = 0; i < n; ++i) m.points.emplace_back(i, 0.5 * i, std::sin(i));
  m.offsets = {0};
  m.body_of_point.assign(n, 0);
  m.body_names = {"cloud"};
  return m;
}

void write_frame(FieldFile& file, const OutputMesh& mesh, int f) {
  file.begin_frame(f, flat(mesh, f));
  file.points("velocity", "m/s", 3, ramp(3 * mesh.points.size(), f));
  file.rows("contact", "gap", "m", 1, ramp(f % 13, f));
  if (f > 3) file.scalar("contact", "work", "J", f);
  file.append_step({.step = double(f)});
  file.end_frame();
}

void expect_frames_whole(const std::string& path, const OutputMesh& mesh, std::int64_t at_least) {
  const FieldReader r(path);
  ASSERT_GE(r.frames(), at_least);
  for (std::int64_t f = 0; f < r.frames(); ++f) {
    expect_f32(r.point_field("velocity", f).values, ramp(3 * mesh.points.size(), f));
    expect_f32(r.rows("contact", "gap", f).values, ramp(f % 13, f));
    const auto x = r.points(f);
    ASSERT_EQ(x.back()[0], mesh.points.back()[0] + f);
  }
}

TEST(FieldFileKilled, EarlierFramesStayReadable) {
  const OutputMesh mesh = cloud(500);
  // Killed at different places within a frame: right after end_frame, and with half a frame written.
  for (const bool half : {false, true}) {
    for (const int frames : {0, 1, 5, 40}) {
      Folder dir;
      const int status = in_child([&] {
        auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {});
        for (int f = 0; f < frames; ++f) write_frame(*file, mesh, f);
        if (half) {
          file->begin_frame(frames, flat(mesh, 0));
          file->points("velocity", "m/s", 3, ramp(3 * mesh.points.size(), -1));
          file->rows("contact", "gap", "m", 1, ramp(3000, -1));
        }
        ::kill(::getpid(), SIGKILL);
        return 0;
      });
      ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
      expect_frames_whole(dir / "fields.vtkhdf", mesh, frames);
      EXPECT_EQ(FieldReader(dir / "fields.vtkhdf").frames(), frames);
      // And the run goes on from there.
      auto file = FieldFile::reopen(dir / "fields.vtkhdf", frames, frames, {});
      write_frame(*file, mesh, frames);
      file->close();
      expect_frames_whole(dir / "fields.vtkhdf", mesh, frames + 1);
    }
  }
}

TEST(FieldFileKilled, FlushedStepsAreThere) {
  Folder dir;
  const OutputMesh mesh = cloud(5);
  in_child([&] {
    auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {});
    write_frame(*file, mesh, 0);
    file->append_step({.step = 1});
    file->append_step({.step = 2});
    file->flush();
    file->append_step({.step = 3});
    ::kill(::getpid(), SIGKILL);
    return 0;
  });
  EXPECT_EQ(FieldReader(dir / "fields.vtkhdf").steps().size(), 3u);
  EXPECT_EQ(FieldFile::reopen(dir / "fields.vtkhdf", 1, 3, {})->frames(), 1);
}

TEST(FieldFileKilled, AtAnyMoment) {
  const OutputMesh mesh = cloud(300);
  for (int trial = 0; trial < 12; ++trial) {
    Folder dir;
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {});
      for (int f = 0;; ++f) {
        write_frame(*file, mesh, f);
        if (::write(ready[1], "x", 1) != 1) ::_exit(1);
      }
    }
    ::close(ready[1]);
    char mark;
    for (int f = 0; f < 3; ++f) ASSERT_EQ(::read(ready[0], &mark, 1), 1);
    ::usleep(731 * trial);
    ::kill(child, SIGKILL);
    int status = 0, seen = 3;
    ::waitpid(child, &status, 0);
    while (::read(ready[0], &mark, 1) == 1) ++seen;
    ::close(ready[0]);
    expect_frames_whole(dir / "fields.vtkhdf", mesh, seen);
  }
}

TEST(FieldFileDiskFull, SaysSoAndKeepsEarlierFrames) {
  const OutputMesh mesh = cloud(2000);
  for (const rlim_t limit : {700'000, 750'000, 763'144, 800'001, 911'111}) {
    Folder dir;
    const int status = in_child([&] {
      ::signal(SIGXFSZ, SIG_IGN);  // writes beyond the limit fail with EFBIG, as they fail with ENOSPC on a full disk
      const rlimit most{limit, limit};
      if (::setrlimit(RLIMIT_FSIZE, &most) != 0) return 90;
      auto file = FieldFile::open(dir / "fields.vtkhdf", mesh, small_info(), {.xdmf = false});
      int done = 0;
      try {
        for (; done < 80; ++done) write_frame(*file, mesh, done);
      } catch (const Error& error) {
        if (error.code() != Exit::file) return 91;
        const std::string message = error.what();
        if (message.find(dir / "fields.vtkhdf") == std::string::npos) return 92;
        if (message.find("File too large") == std::string::npos) return 93;
      }
      try {
        file->begin_frame(0, flat(mesh, 0));
        return 94;
      } catch (const Error&) {
      }
      file->close();
      file.reset();
      std::exit(done);  // with the exit handlers of HDF5
    });
    ASSERT_TRUE(WIFEXITED(status)) << status;
    const int done = WEXITSTATUS(status);
    ASSERT_LT(done, 80) << "code of the child";
    ASSERT_GT(done, 0);
    expect_frames_whole(dir / "fields.vtkhdf", mesh, done);
    EXPECT_EQ(FieldReader(dir / "fields.vtkhdf").frames(), done);
  }
}

TEST(FieldFileOpen, NamesPathAndReason) {
  Folder dir;
  const OutputMesh mesh = small_mesh();
  const auto open = [&](const std::string& path) { return file_error([&] { FieldFile::open(path, mesh, small_info(), {}); }); };
  EXPECT_EQ(open(dir / "no/fields.vtkhdf"), (dir / "no/fields.vtkhdf.new") + ": cannot create: No such file or directory");
  EXPECT_THAT(open("/proc/fields.vtkhdf"), HasSubstr("/proc/fields.vtkhdf.new: cannot create: "));
  EXPECT_THAT(open(dir.path()), HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace mortise::output
