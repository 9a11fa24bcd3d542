#include "run/folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "base/error.h"
#include "render/image.h"
#include "run/camera_file.h"

namespace fs = std::filesystem;

namespace mortise::run {
namespace {

constexpr const char* kLock = "run.lock";
constexpr const char *kEnvironment = "env_", *kEpisode = "episode_";  // and their numbers

bool is_part(const std::string& name) {
  for (const std::string prefix : {kEnvironment, kEpisode})
    if (name.rfind(prefix, 0) == 0 && name.size() >= prefix.size() + 4 && name.find_first_not_of("0123456789", prefix.size()) == std::string::npos)
      return true;
  return false;
}

[[noreturn]] void not_ours(const std::string& path) {
  throw Error(Exit::file, "'" + path + "' was not written by mortise and is left alone; move it away, or choose another folder with -o");
}

// Other programs have such files, too: what does not begin as ours do is somebody else's. An empty one is of a full disk.
void guard_result(const std::string& path, const std::string& mark) {
  std::error_code ec;
  if (!fs::is_regular_file(fs::symlink_status(path, ec))) return;
  std::ifstream in(path, std::ios::binary);
  std::string begin(4096, '\0');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(in.gcount()));
  if (!begin.empty() && begin.find(mark) == std::string::npos) not_ours(path);
}

[[noreturn]] void fail(const std::string& what) { throw Error(Exit::file, what + ": " + std::strerror(errno)); }

std::string host() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

struct Owner {
  std::string host;
  long process = 0;
};

// Of a lock file; no host where it was cut short before it was whole.
Owner owner_of(int file) {
  char text[512] = {};
  const ssize_t n = pread(file, text, sizeof text - 1, 0);
  Owner owner;
  if (n > 0 && text[n - 1] == '\n') std::istringstream(text) >> owner.host >> owner.process;
  return owner;
}

bool same_file(int file, const std::string& path) {
  struct stat a = {}, b = {};
  return fstat(file, &a) == 0 && lstat(path.c_str(), &b) == 0 && a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

}  // namespace

std::string environment_folder(const std::string& folder, long environment) { return fmt::format("{}/{}{:04}", folder, kEnvironment, environment); }

std::string episode_folder(const std::string& folder, long episode) { return fmt::format("{}/{}{:04}", folder, kEpisode, episode); }

std::string folder_of(const Options& o, const Params& scene) {
  if (!o.output.empty()) return o.output;
  std::string name = scene.text("name");
  if (name == "scene" && o.scene != "-") name = fs::path(o.scene).stem().string();  // the default: scenes without a name would share a folder
  const std::string all = "out/" + name, own = o.environment < 0 ? all : environment_folder(all, o.environment);
  return o.episode < 0 ? own : episode_folder(own, o.episode);
}

void Folder::unlock() {
  if (lock_ < 0) return;
  unlink(file(kLock).c_str());
  close(lock_);
  lock_ = -1;
}

bool Folder::exists() const {
  std::error_code ec;
  const fs::file_status status = fs::status(path_, ec);
  if (fs::exists(status) && !fs::is_directory(status)) throw Error(Exit::file, "'" + path_ + "' is not a folder");
  return fs::exists(status);
}

bool Folder::used() const {
  std::error_code ec;
  for (fs::directory_iterator it(path_, ec), end; !ec && it != end; it.increment(ec))
    if (it->path().filename() != kLock) return true;
  return false;
}

namespace {

// Ended processes that nobody has waited for are not.
bool alive(pid_t process) {
  if (kill(process, 0) != 0) return false;
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(in, text);
  const std::size_t after = text.rfind(") ");
  return after == std::string::npos || text[after + 2] != 'Z';
}

}  // namespace

std::string Folder::lock() {
  if (lock_ >= 0) return "";
  std::error_code ec;
  fs::create_directories(path_, ec);
  if (ec) throw Error(Exit::file, "cannot create '" + path_ + "': " + ec.message());
  const std::string path = file(kLock), self = host();
  constexpr int kTries = 20;  // a tenth of a second each: a process that was killed holds its files until the disk has answered
  for (int tries = 0;;) {
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file < 0) fail("cannot create '" + path + "'");
    const bool held = flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    const Owner owner = owner_of(file);
    if (!held && !same_file(file, path)) {  // its owner has just removed it
      close(file);
      continue;
    }
    // A file system without locks: the process is asked for.
    const bool here = owner.host == self,
               lives = held || (here && owner.process != getpid() && owner.process > 0 && alive(static_cast<pid_t>(owner.process)));
    if (lives || (!owner.host.empty() && !here)) {
      close(file);
      if (lives && ++tries < kTries) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        continue;
      }
      const std::string who = owner.host.empty() ? "another process" : "process " + std::to_string(owner.process) + " on " + owner.host;
      throw Error(Exit::file, "'" + path_ + "' is in use by " + who + (here || held ? "" : "\n  if that run is over, remove " + path));
    }
    const std::string text = self + " " + std::to_string(getpid()) + "\n";
    std::size_t written = 0;
    for (ssize_t n = ftruncate(file, 0) == 0 ? 1 : 0; n > 0 && written < text.size(); written += static_cast<std::size_t>(std::max<ssize_t>(n, 0)))
      n = pwrite(file, text.data() + written, text.size() - written, static_cast<off_t>(written));
    if (written < text.size()) {
      const int reason = errno;
      unlink(path.c_str());
      close(file);
      errno = reason;
      fail("cannot write '" + path + "'");
    }
    lock_ = file;
    return owner.host.empty() ? "" : "taking over '" + path_ + "' from process " + std::to_string(owner.process) + ", which is gone";
  }
}

void Folder::remove_results() const {
  std::error_code ec;
  guard_result(file("run.json"), "\"mortise run\"");
  guard_result(file("certificate.json"), "\"mortise certificate\"");
  guard_result(file("fields.xdmf"), "fields.vtkhdf");
  guard_result(file("fields.vtkhdf"), "\x89HDF");
  guard_result(file("checkpoint.h5"), "\x89HDF");
  for (const char* ours : {"fields.vtkhdf",
                           "fields.vtkhdf.new",
                           "fields.vtkhdf.journal",
                           "fields.xdmf",
                           "fields.xdmf.tmp",
                           "run.json",
                           "run.json.tmp",
                           "certificate.json",
                           "certificate.json.tmp",
                           "checkpoint.h5",
                           "checkpoint.h5.tmp",
                           "checkpoint.prev.h5",
                           "checkpoint.prev.h5.tmp",
                           "touching.obj",
                           "touching.obj.tmp",
                           "newton.csv",
                           "episodes.csv",
                           "episodes.csv.tmp",
                           "environments.csv",
                           "environments.csv.tmp",
                           "environments.json",
                           "environments.json.tmp",
                           "bridge.jsonl"})
    if (unlink(file(ours).c_str()) != 0 && errno != ENOENT) fail("cannot replace '" + file(ours) + "'");
  for (fs::directory_iterator it(path_, ec), end; !ec && it != end; it.increment(ec)) {
    if (!is_part(it->path().filename().string()) || !it->is_directory() || it->is_symlink()) continue;
    Folder part(it->path().string());
    part.lock();
    part.remove_results();
    part.unlock();
    rmdir(it->path().c_str());
  }
  const std::string frames = file("frames");
  if (!fs::is_directory(fs::symlink_status(frames, ec))) return;
  for (fs::directory_iterator it(frames, ec), end; !ec && it != end; it.increment(ec))
    if (it->is_regular_file() && !it->is_symlink() &&
        (render::is_our_png(it->path().string()) || is_our_camera_file(it->path().string()) || is_our_depth_array(it->path().string()) ||
         ((it->path().extension() == ".part" || it->path().extension() == ".tmp") && it->file_size() == 0)))
      fs::remove(it->path());
  rmdir(frames.c_str());  // if nothing is left in it
}

void guard_picture(const std::string& path) {
  std::error_code ec;
  const fs::file_status status = fs::symlink_status(path, ec);
  if (fs::exists(status) && !(fs::is_regular_file(status) && (render::is_our_png(path) || is_our_camera_file(path) || is_our_depth_array(path))))
    not_ours(path);
}

void make_pictures_folder(const std::string& path) {
  std::error_code ec;
  if (fs::is_symlink(fs::symlink_status(path, ec))) throw Error(Exit::file, "'" + path + "' is a symbolic link; pictures are not written through it");
  fs::create_directories(path, ec);
  if (ec) throw Error(Exit::file, "cannot create '" + path + "': " + ec.message());
}

}  // namespace mortise::run
