#include "output/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "base/error.h"
#include "base/read_file.h"

namespace mortise::output {
namespace {

[[noreturn]] void fail(const std::string& path, const char* action, int reason) {
  throw Error(Exit::file, path + ": cannot " + action + ": " + std::strerror(reason));
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

void write_file(const std::string& path, std::string_view bytes, bool durable) {
  // What stands there goes first, so that no link is followed; a device (/dev/stdout) is written to.
  struct stat there = {};
  const bool special = ::stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode);
  if (!special) ::unlink(path.c_str());
  const int fd = ::open(path.c_str(), special ? O_WRONLY | O_CLOEXEC : O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (fd < 0) fail(path, "create", errno);
  int reason = 0;
  while (!bytes.empty() && reason == 0) {
    const ssize_t n = ::write(fd, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno != EINTR) {
      reason = errno;
    }
  }
  if (reason == 0 && durable && ::fsync(fd) != 0) reason = errno;
  if (::close(fd) != 0 && reason == 0) reason = errno;  // network file systems report a full disk only here
  if (reason != 0) {
    if (!special) ::unlink(path.c_str());
    fail(path, "write", reason);
  }
}

void rename_file(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail(to, "replace", errno);
}

void keep_file_as(const std::string& from, const std::string& to) {
  const std::string link = to + ".tmp";
  ::unlink(link.c_str());
  if (::link(from.c_str(), link.c_str()) != 0) return rename_file(from, to);
  const bool kept = std::rename(link.c_str(), to.c_str()) == 0;
  const int reason = errno;
  ::unlink(link.c_str());  // still there where `to` was that file already
  if (!kept) fail(to, "replace", reason);
}

void sync_folder_of(const std::string& path) {
  const std::string folder = folder_of(path);
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) fail(folder, "open", errno);
  // Some network file systems cannot sync a folder (EINVAL); their rename is already durable or nothing can be done.
  const int reason = ::fsync(fd) != 0 && errno != EINVAL ? errno : 0;
  ::close(fd);
  if (reason != 0) fail(folder, "sync", reason);
}

void write_file_atomically(const std::string& path, std::string_view bytes, bool durable) {
  const std::string temporary = path + ".tmp";
  write_file(temporary, bytes, durable);
  try {
    rename_file(temporary, path);
  } catch (...) {
    ::unlink(temporary.c_str());
    throw;
  }
  if (durable) sync_folder_of(path);
}

std::string read_file(const std::string& path) { return read_regular_file(path, max_bytes::results); }

}  // namespace mortise::output
