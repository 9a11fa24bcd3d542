#pragma once
#include <string>

#include "base/params.h"
#include "run/options.h"

namespace mortise::run {

// Where a run goes: what -o says, or out/<name>, of a scene without one out/<its file's>; of one of several environments env_0007 in there, of its
// episodes episode_0003 in there.
std::string environment_folder(const std::string& folder, long environment);
std::string episode_folder(const std::string& folder, long episode);
std::string folder_of(const Options& options, const Params& scene);

// The results of one run. While it lives nobody else writes there: DIR/run.lock says who does (host and process), is locked by that process
// and removed by it. What a dead process of this machine left is taken over; of a process on another machine we cannot know, so that is an error.
class Folder {
 public:
  explicit Folder(std::string path) : path_(std::move(path)) {}
  ~Folder() { unlock(); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::string& path() const { return path_; }
  std::string file(const char* name) const { return path_ + "/" + name; }
  bool exists() const;
  bool used() const;  // anything but the lock is in it
  // Makes the folder where it is missing. Returns a sentence about a lock that was taken over, or "".
  std::string lock();
  void unlock();
  // Removes the results of an earlier run: files of our names, and in frames/ the pictures and camera files that we wrote. Links go, what they point
  // to stays; so does everything else. Throws Error(Exit::file) where a file of such a name is not ours. Folders of environments go where nothing is
  // left in them.
  void remove_results() const;

 private:
  std::string path_;
  int lock_ = -1;
};

// Throws Error(Exit::file) where `path` is something that we did not write: only pictures and camera files of ours are replaced.
void guard_picture(const std::string& path);

// DIR/frames, made where it is missing. Throws Error(Exit::file) where it is a link, which would lead out of the folder.
void make_pictures_folder(const std::string& path);

}  // namespace mortise::run
