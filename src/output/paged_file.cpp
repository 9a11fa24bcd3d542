#include "output/paged_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/error.h"
#include "base/sha256.h"
#include "output/atomic_file.h"
#include "output/tuning.h"

namespace mortise::output {
namespace {

constexpr std::string_view kMark = "mortise journal 1\n";
constexpr std::size_t kSum = 64;  // hexadecimal digits of SHA-256

void put(std::string& out, std::uint64_t value) { out.append(reinterpret_cast<const char*>(&value), sizeof value); }

std::uint64_t read_number(std::string_view& in) {
  std::uint64_t value = 0;
  std::memcpy(&value, in.data(), sizeof value);
  in.remove_prefix(sizeof value);
  return value;
}

// Returns false with errno set.
bool write_all(int fd, std::uint64_t at, const char* bytes, std::uint64_t count) {
  while (count > 0) {
    const ssize_t n = ::pwrite(fd, bytes, count, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) return false;
    at += static_cast<std::uint64_t>(n), bytes += n, count -= static_cast<std::uint64_t>(n);
  }
  return true;
}

}  // namespace

void PagedFile::fail(const std::string& path, const char* action) const {
  throw Error(Exit::file, path + ": cannot " + action + ": " + std::strerror(errno));
}

PagedFile::PagedFile(const std::string& path, Access access) : path_(path), changes_(access != Access::read) {
  if (access == Access::create) {
    if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail(path, "create");
    fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd_ < 0) fail(path, "create");
    return;
  }
  fd_ = ::open(path.c_str(), (changes_ ? O_RDWR | O_NOFOLLOW : O_RDONLY) | O_NONBLOCK | O_CLOEXEC);  // a pipe would wait for its other end
  if (fd_ < 0) fail(path, "open");
  struct stat status = {};
  const bool known = ::fstat(fd_, &status) == 0;
  if (!known || !S_ISREG(status.st_mode)) {
    ::close(fd_);
    if (!known) fail(path, "open");
    throw Error(Exit::file, path + ": cannot open: it is not a regular file");
  }
  end_ = committed_ = on_disk_ = static_cast<std::uint64_t>(status.st_size);
  try {
    Pages pages;
    std::uint64_t end = 0;
    if (!read_journal(pages, end)) return;
    if (changes_) {
      apply(pages, end);
      remove_journal();
    } else {
      pages_ = std::move(pages), end_ = end;
    }
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

PagedFile::~PagedFile() {
  if (journal_ >= 0) ::close(journal_);
  if (fd_ >= 0) ::close(fd_);
}

void PagedFile::read_file(std::uint64_t at, char* bytes, std::uint64_t count) const {
  while (count > 0) {
    const ssize_t n = ::pread(fd_, bytes, count, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(path_, "read");
    if (n == 0) break;
    at += static_cast<std::uint64_t>(n), bytes += n, count -= static_cast<std::uint64_t>(n);
  }
  std::fill(bytes, bytes + count, '\0');
}

void PagedFile::read(std::uint64_t at, char* bytes, std::uint64_t count) const {
  while (count > 0) {
    const auto next = pages_.lower_bound(at / kPage);
    if (next != pages_.end() && next->first == at / kPage) {
      const std::uint64_t from = at % kPage, n = std::min(count, kPage - from);
      std::copy_n(next->second.data() + from, n, bytes);
      at += n, bytes += n, count -= n;
    } else {
      const std::uint64_t n = next == pages_.end() ? count : std::min(count, next->first * kPage - at);
      read_file(at, bytes, n);
      at += n, bytes += n, count -= n;
    }
  }
}

PagedFile::Page& PagedFile::page(std::uint64_t number, bool whole) {
  const auto [it, fresh] = pages_.try_emplace(number);
  if (fresh && !whole && number * kPage < on_disk_) read_file(number * kPage, it->second.data(), kPage);
  return it->second;
}

void PagedFile::write_file(std::uint64_t at, const char* bytes, std::uint64_t count) {
  if (!write_all(fd_, at, bytes, count)) fail(path_, "write");
  on_disk_ = std::max(on_disk_, at + count);
}

void PagedFile::write(std::uint64_t at, const char* bytes, std::uint64_t count) {
  if (forgotten_) return;
  end_ = std::max(end_, at + count);
  while (count > 0) {
    const std::uint64_t number = at / kPage, from = at % kPage;
    if (changes_ && from == 0 && at >= committed_ && count >= tuning::kLong) {
      const std::uint64_t n = count - count % kPage;
      write_file(at, bytes, n);
      pages_.erase(pages_.lower_bound(number), pages_.lower_bound((at + n) / kPage));
      at += n, bytes += n, count -= n;
      continue;
    }
    const std::uint64_t n = std::min(count, kPage - from);
    std::copy_n(bytes, n, page(number, n == kPage).data() + from);
    at += n, bytes += n, count -= n;
  }
}

void PagedFile::sync(int fd, const std::string& path) const {
  if (::fdatasync(fd) != 0) fail(path, "write");
}

void PagedFile::write_journal() {
  const std::string path = journal_path();
  if (journal_ < 0) {
    if (::unlink(path.c_str()) != 0 && errno != ENOENT) fail(path, "create");
    journal_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (journal_ < 0) fail(path, "create");
    sync_folder_of(path);
  }
  std::string bytes(kMark);
  bytes.reserve(kMark.size() + 16 + pages_.size() * (8 + kPage) + kSum);
  put(bytes, end_), put(bytes, pages_.size());
  for (const auto& [number, content] : pages_) put(bytes, number), bytes.append(content.data(), kPage);
  bytes += sha256(bytes);
  if (!write_all(journal_, 0, bytes.data(), bytes.size())) fail(path, "write");
  sync(journal_, path);
  journal_valid_ = true;
}

void PagedFile::empty_journal() {
  if (journal_ < 0) return;
  if (::ftruncate(journal_, 0) != 0) fail(journal_path(), "write");
  journal_valid_ = false;
}

void PagedFile::remove_journal() {
  if (!changes_) return;
  if (journal_ >= 0) ::close(journal_);
  journal_ = -1;
  if (::unlink(journal_path().c_str()) != 0 && errno != ENOENT) fail(journal_path(), "remove");
}

bool PagedFile::read_journal(Pages& pages, std::uint64_t& end) const {
  struct stat status = {};
  if (::lstat(journal_path().c_str(), &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) return false;
  const std::string all = output::read_file(journal_path());
  std::string_view in = all;
  if (in.size() < kMark.size() + 16 + kSum || in.substr(0, kMark.size()) != kMark) return false;
  const std::string_view sum = in.substr(in.size() - kSum);
  in.remove_suffix(kSum);
  if (sha256(in) != sum) return false;
  in.remove_prefix(kMark.size());
  end = read_number(in);
  if (const std::uint64_t count = read_number(in); in.size() != count * (8 + kPage)) return false;
  while (!in.empty()) {
    Page& page = pages[read_number(in)];
    std::copy_n(in.data(), kPage, page.data());
    in.remove_prefix(kPage);
  }
  return true;
}

void PagedFile::write_pages(const Pages& pages, std::uint64_t end) {
  std::string run;
  for (auto it = pages.begin(); it != pages.end();) {
    const std::uint64_t first = it->first * kPage;
    run.clear();
    for (std::uint64_t next = it->first; it != pages.end() && it->first == next && run.size() < tuning::kRun; ++it, ++next)
      run.append(it->second.data(), kPage);
    if (first < end) write_file(first, run.data(), std::min<std::uint64_t>(run.size(), end - first));
  }
}

void PagedFile::apply(const Pages& pages, std::uint64_t end) {
  write_pages(pages, end);
  if (on_disk_ != end && ::ftruncate(fd_, static_cast<off_t>(end)) != 0) fail(path_, "write");
  on_disk_ = end_ = committed_ = end;
  sync(fd_, path_);
}

void PagedFile::commit() {
  if (!changes_ || forgotten_ || (pages_.empty() && on_disk_ == end_ && committed_ == end_)) return;
  Pages fresh;  // wholly behind the last commit: nobody looks there yet
  for (auto it = pages_.lower_bound((committed_ + kPage - 1) / kPage); it != pages_.end();) fresh.insert(pages_.extract(it++));
  if (pages_.empty() && end_ >= committed_) return apply(fresh, end_);
  write_pages(fresh, end_);
  sync(fd_, path_);
  write_journal();
  apply(pages_, end_);
  pages_.clear();
  empty_journal();
}

void PagedFile::forget() noexcept {
  if (forgotten_) return;
  forgotten_ = true;
  pages_.clear();
  if (!changes_ || journal_valid_) return;  // the commit holds: opening the file again carries it out
  const bool cut = ::ftruncate(fd_, static_cast<off_t>(committed_)) == 0;
  (void)cut;  // bytes behind the end do no harm
  if (journal_ >= 0) ::close(journal_), ::unlink(journal_path().c_str());
  journal_ = -1;
}

void PagedFile::rename(const std::string& path) {
  remove_journal();
  // A journal of the file that stood there before must not be taken for one of this file.
  const std::string before = path + ".journal";
  if (::unlink(before.c_str()) != 0 && errno != ENOENT) fail(before, "remove");
  rename_file(path_, path);
  sync_folder_of(path);
  path_ = path;
}

}  // namespace mortise::output
