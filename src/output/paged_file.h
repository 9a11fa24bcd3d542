#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace mortise::output {

// A file that goes from one committed state to the next in one step, whatever is cut short in between: a kill, a power cut, a full
// disk. What a commit adds behind the end of the last one is written first, where nobody looks yet; what it changes below that end goes
// through a journal beside the file (PATH.journal) with a checksum:
//
//     new bytes behind the end, sync   ->   journal, sync   ->   change the file, sync   ->   empty the journal
//
// A whole journal is carried out (again) when the file is opened, a torn one is of a commit that never was. Every failure throws
// Error(Exit::file) with path and reason. Symbolic links are not followed where anything is written.
class PagedFile {
 public:
  enum class Access {
    create,
    write,
    read
  };  // create: replaces what is there; read: changes neither file nor journal, and keeps in memory what is written
  PagedFile(const std::string& path, Access access);
  ~PagedFile();
  PagedFile(const PagedFile&) = delete;
  PagedFile& operator=(const PagedFile&) = delete;

  const std::string& path() const { return path_; }
  std::uint64_t end() const { return end_; }                            // in bytes, with what is not committed yet
  void read(std::uint64_t at, char* bytes, std::uint64_t count) const;  // zeros behind the end
  void write(std::uint64_t at, const char* bytes, std::uint64_t count);
  void set_end(std::uint64_t end) { end_ = end; }
  void commit();
  // Drops what was not committed, and whatever is written from now on.
  void forget() noexcept;
  // To another name in the same folder, which replaces what is there.
  void rename(const std::string& path);
  void remove_journal();

 private:
  static constexpr std::uint64_t kPage = 4096;
  using Page = std::array<char, kPage>;
  using Pages = std::map<std::uint64_t, Page>;  // by number

  std::string journal_path() const { return path_ + ".journal"; }
  Page& page(std::uint64_t number, bool whole);
  void read_file(std::uint64_t at, char* bytes, std::uint64_t count) const;
  void write_file(std::uint64_t at, const char* bytes, std::uint64_t count);
  void write_journal();
  void empty_journal();
  // What the journal says was committed; false where there is none or only part of one.
  bool read_journal(Pages& pages, std::uint64_t& end) const;
  void write_pages(const Pages& pages, std::uint64_t end);
  void apply(const Pages& pages, std::uint64_t end);
  void sync(int fd, const std::string& path) const;
  [[noreturn]] void fail(const std::string& path, const char* action) const;  // with errno

  std::string path_;
  bool changes_ = true;  // not with Access::read
  int fd_ = -1, journal_ = -1;
  std::uint64_t end_ = 0;
  std::uint64_t committed_ = 0;  // end of the last commit
  std::uint64_t on_disk_ = 0;    // size of the file
  Pages pages_;                  // changed since the last commit (read: changed by the journal)
  bool forgotten_ = false, journal_valid_ = false;
};

}  // namespace mortise::output
