#include "device/trap.h"

#ifndef __CUDACC__
#include <execinfo.h>
#include <signal.h>
#include <sys/mman.h>
#include <ucontext.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "base/error.h"

namespace mortise::device::trap {

bool on = false;

namespace {

constexpr std::size_t kReserved = std::size_t{1} << 38;     // addresses, not memory
constexpr std::size_t kStep = std::size_t{64} << 20;        // the range in use grows by this
constexpr std::size_t kFence = 64;                          // bytes behind every block that nobody may write
constexpr std::size_t kQuarantine = std::size_t{32} << 20;  // released bytes that are kept unused
constexpr unsigned char kUndefined = 0xff, kFenceByte = 0xa5;

struct Block {
  std::size_t bytes = 0, size = 0;  // asked for; taken, with the fence
  bool live = false;
};

struct Arena {
  char *base = nullptr, *top = nullptr, *next = nullptr;  // [base, top) is in use or can be, [next, top) never was
  std::map<const char*, Block> blocks;
  std::map<std::size_t, std::vector<char*>> free;  // by size
  std::deque<char*> quarantine;                    // oldest first
  std::size_t quarantined = 0, live = 0, limit = 0;
  int depth = 0;  // of Open
  const char* last = "none yet";
  std::mutex mutex;
};
Arena& arena() {
  static Arena* a = new Arena;  // outlives every Buffer
  return *a;
}
struct sigaction previous;

void protect(int how) {
  Arena& a = arena();
  if (mprotect(a.base, static_cast<std::size_t>(a.top - a.base), how) != 0)
    throw Error(Exit::device, "debug device: cannot change the protection of its memory");
}

bool inside(const void* p) {
  const Arena& a = arena();
  return p >= a.base && p < a.base + kReserved;
}

// The block that p points into or right behind; nullptr where there never was one.
const std::pair<const char* const, Block>* find(const void* p) {
  Arena& a = arena();
  auto it = a.blocks.upper_bound(static_cast<const char*>(p));
  if (it == a.blocks.begin()) return nullptr;
  --it;
  return static_cast<const char*>(p) < it->first + it->second.size ? &*it : nullptr;
}

std::string describe(const void* p) {
  const auto* block = find(p);
  if (!block) return "memory of no buffer";
  return "byte " + std::to_string(static_cast<const char*>(p) - block->first) + " of a " + (block->second.live ? "" : "released ") + "buffer of " +
         std::to_string(block->second.bytes) + " bytes";
}

// The program ends here: the host code that touched the device's memory knows nothing of it.
void on_fault(int signal, siginfo_t* info, void* context) {
  if (!inside(info->si_addr)) {
    sigaction(signal, &previous, nullptr);  // the fault comes again, and meets whoever was there before
    return;
  }
  const char* how = "touches";
#ifdef __x86_64__
  how = (static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_ERR] & 2) ? "writes to" : "reads from";
#else
  (void)context;
#endif
  std::fflush(stdout);
  std::fprintf(stderr,
               "error: debug device: host code %s device memory (%s); last kernel or copy: '%s'\n"
               "  on a GPU this is a crash: buffers are reached by upload() and download() only. Callers:\n",
               how, describe(info->si_addr).c_str(), arena().last);
  void* frames[24];
  const int n = backtrace(frames, 24);
  std::fflush(stderr);
  if (n > 2) backtrace_symbols_fd(frames + 2, n - 2, STDERR_FILENO);
  _exit(static_cast<int>(Exit::internal));
}

// Sizes in steps of an eighth, so that blocks can be used again.
std::size_t rounded(std::size_t bytes) {
  std::size_t step = 64;
  while (step * 8 < bytes) step *= 2;
  return (bytes + step - 1) / step * step;
}

bool all(const char* p, std::size_t bytes, unsigned char value) {
  for (std::size_t i = 0; i < bytes; ++i)
    if (static_cast<unsigned char>(p[i]) != value) return false;
  return true;
}

// Reached from destructors too, which cannot throw: the program ends.
[[noreturn]] void corrupted(const std::string& what) {
  std::fprintf(stderr, "error: debug device: %s; last kernel or copy: '%s'\n", what.c_str(), arena().last);
  std::fflush(stderr);
  _exit(static_cast<int>(Exit::internal));
}

void leave_quarantine(std::size_t limit) {
  Arena& a = arena();
  while (a.quarantined > limit) {
    char* p = a.quarantine.front();
    a.quarantine.pop_front();
    const Block& b = a.blocks.at(p);
    if (!all(p, b.bytes, kUndefined)) corrupted("a kernel wrote into a released buffer of " + std::to_string(b.bytes) + " bytes");
    a.quarantined -= b.size;
    a.free[b.size].push_back(p);
  }
}

char* carve(std::size_t size) {
  Arena& a = arena();
  auto& same = a.free[size];
  if (!same.empty()) {
    char* p = same.back();
    same.pop_back();
    return p;
  }
  while (a.next + size > a.top) {
    if (a.top + kStep > a.base + kReserved) throw Error(Exit::device, "debug device: out of addresses");
    a.top += kStep;
  }
  char* p = a.next;
  a.next += size;
  return p;
}

bool mapped(std::uint64_t address) {
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  unsigned char unused;
  return mincore(reinterpret_cast<void*>(address / page * page), 1, &unused) == 0;
}

}  // namespace

void start() {
  if (on) return;
  Arena& a = arena();
  const char* limit = std::getenv("MORTISE_DEBUG_MEMORY_MIB");
  a.limit = limit && std::atof(limit) > 0 ? static_cast<std::size_t>(std::atof(limit) * (1 << 20))
                                          : static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  // The first block lies kStep behind a multiple of 2^32: two integers side by side in a closure, the lower one below kStep, are no address of a
  // block.
  constexpr std::size_t kHalf = std::size_t{1} << 32;
  void* p = mmap(nullptr, kReserved + 2 * kHalf, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (p == MAP_FAILED) throw Error(Exit::device, "debug device: cannot reserve addresses");
  a.base = a.top = a.next = reinterpret_cast<char*>((reinterpret_cast<std::uintptr_t>(p) / kHalf + 1) * kHalf + kStep);
  munmap(p, static_cast<std::size_t>(a.base - static_cast<char*>(p)));
  munmap(a.base + kReserved, static_cast<std::size_t>(static_cast<char*>(p) + 2 * kHalf - a.base));
  madvise(a.base, kReserved, MADV_HUGEPAGE);  // fewer pages to protect at every launch
  void* frame[1];
  backtrace(frame, 1);  // loads what it needs now, not in the handler
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigaction(SIGSEGV, &action, &previous);
  on = true;
}

std::size_t memory() { return arena().limit; }

void* allocate(std::size_t bytes) {
  Arena& a = arena();
  const std::lock_guard lock(a.mutex);
  if (a.live + bytes > a.limit) return nullptr;
  const std::size_t size = rounded(bytes + kFence);
  char* p = carve(size);
  a.live += bytes;
  a.blocks[p] = {bytes, size, true};
  protect(PROT_READ | PROT_WRITE);
  std::memset(p, kUndefined, bytes);
  std::memset(p + bytes, kFenceByte, kFence);
  if (a.depth == 0) protect(PROT_NONE);
  return p;
}

void release(void* memory, std::size_t bytes) {
  Arena& a = arena();
  const std::lock_guard lock(a.mutex);
  char* p = static_cast<char*>(memory);
  Block& b = a.blocks.at(p);
  if (!b.live || b.bytes != bytes) corrupted("a buffer of " + std::to_string(b.bytes) + " bytes was released twice or with another size");
  protect(PROT_READ | PROT_WRITE);
  if (!all(p + bytes, kFence, kFenceByte)) corrupted("a kernel wrote behind the end of a buffer of " + std::to_string(bytes) + " bytes");
  std::memset(p, kUndefined, bytes);
  b.live = false;
  a.live -= bytes;
  a.quarantine.push_back(p);
  a.quarantined += b.size;
  leave_quarantine(kQuarantine);
  if (a.depth == 0) protect(PROT_NONE);
}

bool owns(const void* p) { return on && inside(p); }

void forget(void* p, std::size_t bytes) {
  if (!owns(p)) return;
  const Open open("resize");
  std::memset(p, kUndefined, bytes);
}

void check_range(const void* p, std::size_t bytes, const char* what) {
  if (!on || bytes == 0) return;
  const auto* block = inside(p) ? find(p) : nullptr;
  const char* from = static_cast<const char*>(p);
  if (block && block->second.live && from + bytes <= block->first + block->second.bytes) return;
  throw Error(Exit::internal, std::string("debug device: ") + what + " of " + std::to_string(bytes) + " bytes at " +
                                  (inside(p) ? describe(p) : "host memory, where device memory is meant"));
}

void check_closure(const char* kernel, const void* closure, std::size_t bytes) {
  // Doubles, and integers in pairs whose second one is outside 20,480..32,767, have other upper halves than the addresses of programs, heaps and
  // stacks.
  constexpr std::uint64_t kLeast = 0x5000ull << 32, kEnd = 0x8000ull << 32;
  for (std::size_t at = 0; at + 8 <= bytes; at += 8) {
    std::uint64_t word;
    std::memcpy(&word, static_cast<const char*>(closure) + at, 8);
    if (word < kLeast || word >= kEnd) continue;
    const void* p = reinterpret_cast<const void*>(word);
    const auto complain = [&](const std::string& what) {
      throw Error(Exit::internal,
                  std::string("debug device: kernel '") + kernel + "' captures " + what + " (byte " + std::to_string(at) + " of its closure)");
    };
    if (inside(p)) {
      const std::lock_guard lock(arena().mutex);
      const auto* block = find(p);  // none: two integers, no address that was ever given out
      if (block && !block->second.live) complain("a stale address: " + describe(p));
    } else if (mapped(word)) {
      complain("an address of host memory, which means nothing on a GPU");
    }
  }
}

void Open::open(const char* what) {
  Arena& a = arena();
  const std::lock_guard lock(a.mutex);
  a.last = what;
  if (a.depth++ == 0) protect(PROT_READ | PROT_WRITE);
}

void Open::close() {
  Arena& a = arena();
  const std::lock_guard lock(a.mutex);
  if (--a.depth == 0) protect(PROT_NONE);
}

}  // namespace mortise::device::trap
#endif
