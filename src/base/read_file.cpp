#include "base/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"

namespace mortise {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& reason) { throw Error(Exit::file, "cannot read '" + path + "': " + reason); }
[[noreturn]] void fail(const std::string& path) { fail(path, std::strerror(errno)); }

class File {
 public:
  File(const std::string& path, int flags)
      : path_(path), file_(path == "-" ? ::dup(STDIN_FILENO) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | flags)) {
    if (file_ < 0) fail(path);
  }
  ~File() { ::close(file_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  struct stat status() const {
    struct stat s = {};
    if (::fstat(file_, &s) != 0) fail(path_);
    if (S_ISDIR(s.st_mode)) fail(path_, "it is a folder");
    return s;
  }
  // Up to `count` bytes; less only at the end.
  std::size_t read(char* bytes, std::size_t count) const {
    std::size_t done = 0;
    while (done < count) {
      const ssize_t n = ::read(file_, bytes + done, count - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(path_);
      if (n == 0) break;
      done += static_cast<std::size_t>(n);
    }
    return done;
  }

 private:
  const std::string& path_;
  int file_;
};

std::string too_long(std::uint64_t limit) { return "it is longer than " + std::to_string(limit >> 20) + " MiB"; }

}  // namespace

std::string read_regular_file(const std::string& path, std::uint64_t limit) {
  const File file(path, O_NONBLOCK);
  const struct stat status = file.status();
  if (!S_ISREG(status.st_mode)) fail(path, "it is not a regular file");
  const auto size = static_cast<std::uint64_t>(status.st_size);
  if (size > limit) fail(path, too_long(limit));
  std::string bytes(size, '\0');
  if (file.read(bytes.data(), size) != size) fail(path, "it ends before its length of " + std::to_string(size) + " bytes");
  return bytes;
}

std::string read_stream(const std::string& path, std::uint64_t limit) {
  const File file(path, 0);
  file.status();
  constexpr std::size_t kPiece = 1 << 16;
  std::string bytes;
  for (std::size_t n = kPiece; n == kPiece;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kPiece);
    n = file.read(bytes.data() + before, kPiece);
    bytes.resize(before + n);
    if (bytes.size() > limit) fail(path, too_long(limit));
  }
  return bytes;
}

}  // namespace mortise
