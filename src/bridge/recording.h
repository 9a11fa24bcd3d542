#pragma once
// What a partner said in one run, as the run's folder keeps it: FOLDER/bridge.jsonl, a line for the run and one per message. The file is added to
// before a message is acted on, so a run that was killed can take every step again that it took.
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mortise::bridge {

inline constexpr const char* kRecordingFile = "bridge.jsonl";

class Recording {
 public:
  struct Entry {
    long step = 0;     // that it answers
    std::string said;  // the message, as JSON
  };

  Recording() = default;
  // Of another run. Throws Error(Exit::file) where it cannot be read or is none; a last line that was cut short is left out.
  static Recording read(const std::string& path);

  // Begins the file anew, or goes on with what it holds. Throws Error(Exit::file).
  void create(const std::string& path, const std::string& scene_sha256, long every);
  void reopen(const std::string& path);
  void add(long step, const std::string& said);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  Recording(Recording&& other) noexcept { swap(other); }
  Recording& operator=(Recording&& other) noexcept {
    swap(other);
    return *this;
  }

  const std::vector<Entry>& entries() const { return entries_; }
  const std::string& scene_sha256() const { return scene_; }
  long every() const { return every_; }
  const std::string& path() const { return path_; }
  bool ends_with(const char* word) const;  // "reset": does its last message say so?

 private:
  void swap(Recording& other) noexcept;
  void write(const std::string& line);
  std::string path_, scene_;
  long every_ = 1;
  std::vector<Entry> entries_;
  std::size_t whole_ = 0;  // bytes of whole lines
  int file_ = -1;
};

}  // namespace mortise::bridge
