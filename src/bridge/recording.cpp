#include "bridge/recording.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "base/json_text.h"
#include "output/atomic_file.h"

namespace mortise::bridge {
namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void fail(const std::string& what) { throw Error(Exit::file, what + ": " + std::strerror(errno)); }

}  // namespace

Recording::~Recording() {
  if (file_ >= 0) close(file_);
}

void Recording::swap(Recording& other) noexcept {
  std::swap(path_, other.path_), std::swap(scene_, other.scene_), std::swap(every_, other.every_);
  std::swap(entries_, other.entries_), std::swap(whole_, other.whole_), std::swap(file_, other.file_);
}

Recording Recording::read(const std::string& path) {
  Recording out;
  out.path_ = path;
  const std::string text = output::read_file(path);
  int number = 0;
  for (std::size_t at; (at = text.find('\n', out.whole_)) != std::string::npos; out.whole_ = at + 1) {
    ++number;
    try {
      const Json j = Json::parse(text.substr(out.whole_, at - out.whole_));
      if (number == 1) {
        if (j.at("filetype") != "mortise bridge" || j.at("version") != 1) throw Error(Exit::file, "'" + path + "' is no recording of a bridge (1)");
        out.scene_ = j.at("scene_sha256").get<std::string>(), out.every_ = j.at("every").get<long>();
      } else {
        out.entries_.push_back({j.at("step").get<long>(), json_text(j.at("said"))});
      }
      if (out.every_ < 1 || (number > 1 && out.entries_.back().step % out.every_ != 0 && !j.at("said").contains("reset")) ||
          (number > 2 && out.entries_.back().step <= out.entries_[out.entries_.size() - 2].step))
        throw Error(Exit::file, SourceLoc{path, number, 1}, "the steps of a recording increase, control step by control step");
    } catch (const Json::exception&) {
      throw Error(Exit::file, SourceLoc{path, number, 1}, "this is no line of a recording of a bridge");
    }
  }
  if (number == 0) throw Error(Exit::file, "'" + path + "' is no recording of a bridge: its first line is not whole");
  return out;
}

void Recording::create(const std::string& path, const std::string& scene_sha256, long every) {
  *this = Recording();
  path_ = path, scene_ = scene_sha256, every_ = every;
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (file_ < 0) fail("cannot create '" + path + "'");
  write(json_text(Json{{"filetype", "mortise bridge"}, {"version", 1}, {"scene_sha256", scene_sha256}, {"every", every}}));
}

void Recording::reopen(const std::string& path) {
  *this = read(path);
  file_ = open(path.c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
  if (file_ < 0 || ftruncate(file_, static_cast<off_t>(whole_)) != 0 || lseek(file_, 0, SEEK_END) < 0) fail("cannot write '" + path + "'");
}

void Recording::add(long step, const std::string& said) {
  write(fmt::format(R"({{"step":{},"said":{}}})", step, said));
  entries_.push_back({step, said});
}

void Recording::write(const std::string& line) {
  const std::string text = line + "\n";
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t n = ::write(file_, text.data() + done, text.size() - done);
    if (n < 0 && errno != EINTR) fail("cannot write '" + path_ + "'");
    if (n > 0) done += static_cast<std::size_t>(n);
  }
}

bool Recording::ends_with(const char* word) const { return !entries_.empty() && Json::parse(entries_.back().said).contains(word); }

}  // namespace mortise::bridge
