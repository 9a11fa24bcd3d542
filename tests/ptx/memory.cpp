#include "memory.h"

#include <sys/mman.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <vector>

#include "report.h"

// The variables of the module (machine.h, TABLE) are device memory too; the linker knows where they are, if there are any.
extern "C" __attribute__((weak, visibility("hidden"))) const char __start_ptx_tables[], __stop_ptx_tables[];

namespace ptx {
namespace {

constexpr std::size_t kRange = std::size_t{32} << 30;
constexpr std::size_t kGuard = 256;     // bytes between buffers, and their alignment, as cudaMalloc's
constexpr std::size_t kQuarantine = 4;  // released buffers of one size before the first of them is used again
constexpr std::uint32_t kMany = ~0u;    // read by several threads

// Who touched 4 bytes last, in which launch; and a bit for each of them: allocated, written.
struct Word {
  std::uint32_t writer, written_in, reader, read_in;
  std::uint8_t allocated, written;
};

template <class T>
T* reserve(std::size_t bytes) {
  void* p = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (p == MAP_FAILED) {
    std::perror("ptx: addresses for the device's memory");
    std::abort();
  }
  return static_cast<T*>(p);
}

struct Memory {
  char* const base = reserve<char>(kRange);
  Word* const words = ptx_checked ? reserve<Word>(kRange / 4 * sizeof(Word)) : nullptr;
  char* top = base;
  std::map<const char*, std::size_t> live;
  std::map<std::size_t, std::vector<char*>> released;
  std::size_t used = 0;
  std::uint32_t launch = 1;
  Traffic traffic;

  Word& word(const void* p) { return words[(static_cast<const char*>(p) - base) / 4]; }
  static unsigned bit(const void* p) { return 1u << (reinterpret_cast<std::uintptr_t>(p) & 3); }
};
Memory& memory() {
  static Memory m;
  return m;
}

template <class Each>
void each_byte(const void* p, std::size_t bytes, Each each) {
  if (!ptx_checked) return;
  for (std::size_t i = 0; i < bytes; ++i) each(memory().word(static_cast<const char*>(p) + i), Memory::bit(static_cast<const char*>(p) + i), i);
}

const char* const kDoes[] = {"reads", "writes", "changes atomically"};

}  // namespace

char* allocate(std::size_t bytes) {
  Memory& m = memory();
  if (m.used + bytes > settings().memory) return nullptr;
  const std::size_t size = (bytes + 2 * kGuard - 1) / kGuard * kGuard;
  std::vector<char*>& again = m.released[size];
  char* p = nullptr;
  if (again.size() > kQuarantine) {
    p = again.front();
    again.erase(again.begin());
  } else {
    if (m.top + size + 4096 > m.base + kRange) return nullptr;
    p = m.top;
    m.top += (size + 4095) / 4096 * 4096;
  }
  if (ptx_checked) std::memset(p, 0xff, bytes);
  each_byte(p, bytes, [](Word& w, unsigned bit, std::size_t) { w.allocated |= bit, w.written &= ~bit; });
  m.live[p] = bytes;
  m.used += bytes;
  return p;
}

bool release(void* p) {
  Memory& m = memory();
  const auto it = m.live.find(static_cast<char*>(p));
  if (it == m.live.end()) return false;
  if (ptx_checked) std::memset(p, 0xff, it->second);
  each_byte(p, it->second, [](Word& w, unsigned, std::size_t) { w = {}; });
  m.released[(it->second + 2 * kGuard - 1) / kGuard * kGuard].push_back(static_cast<char*>(p));
  m.used -= it->second;
  m.live.erase(it);
  return true;
}
std::size_t in_use() { return memory().used; }

bool on_device(const void* p) { return p >= memory().base && p < memory().base + kRange; }

bool one_buffer(const void* p, std::size_t bytes) {
  const auto it = memory().live.upper_bound(static_cast<const char*>(p));
  if (it == memory().live.begin()) return false;
  const auto& [start, size] = *std::prev(it);
  return static_cast<const char*>(p) + bytes <= start + size;
}

std::string place(const void* p) {
  const auto it = memory().live.upper_bound(static_cast<const char*>(p));
  if (it == memory().live.begin()) return "no buffer";
  const auto& [start, size] = *std::prev(it);
  return "byte " + std::to_string(static_cast<const char*>(p) - start) + " of a buffer of " + std::to_string(size) + " bytes";
}

void next_launch() {
  ++memory().launch;
  memory().traffic = {};
}
Traffic traffic() { return memory().traffic; }
void mark_written(void* p, std::size_t bytes) {
  each_byte(p, bytes, [](Word& w, unsigned bit, std::size_t) { w.written |= bit; });
}
void mark_copied(void* to, const void* from, std::size_t bytes) {
  each_byte(to, bytes, [from](Word& w, unsigned bit, std::size_t i) {
    const char* source = static_cast<const char*>(from) + i;
    w.written = memory().word(source).written & Memory::bit(source) ? w.written | bit : w.written & ~bit;
  });
}
std::size_t never_written(const void* p, std::size_t bytes) {
  std::size_t n = 0, run = 0;
  each_byte(p, bytes, [&](Word& w, unsigned bit, std::size_t) {
    run = w.written & bit ? 0 : run + 1;
    if (run % 8 == 0 && run > 0) n += 8;
  });
  return n;
}

}  // namespace ptx

using namespace ptx;

namespace {
void fault(const Thread* t, Access how, const char* what, const std::string& where) {
  report(std::string(what) + " (" + kDoes[how] + ") in " + readable(t->kernel),
         "thread " + std::to_string(t->number - 1) + (where.empty() ? "" : ", " + where));
}
}  // namespace

// Races are looked for among threads that do not meet, and among accesses of at least 4 bytes.
void ptx_check(Thread* t, std::uint64_t address, std::uint32_t size, Access how) {
  const char* p = reinterpret_cast<const char*>(address);
  if (address % size != 0) fault(t, how, "misaligned access", on_device(p) ? place(p) : "");
  if (!on_device(p)) {
    const char* here = static_cast<const char*>(__builtin_frame_address(0));
    const bool local = p >= here && p + size <= reinterpret_cast<const char*>(t->stack_end);
    const bool table = p >= __start_ptx_tables && p + size <= __stop_ptx_tables;
    const bool shared = t->shared && address >= reinterpret_cast<std::uint64_t>(t->shared) &&
                        address + size <= reinterpret_cast<std::uint64_t>(t->shared) + t->shared_bytes;
    if (!local && !table && !shared) {
      fault(t, how, "access to host memory", "");
      std::fflush(stderr);
    }
    return;
  }
  Memory& m = memory();
  m.traffic.accessed += size;
  for (std::uint32_t i = 0; i < size; i += 4) {
    Word& w = m.word(p + i);
    if (w.read_in != m.launch && w.written_in != m.launch) m.traffic.touched += 4;
    const unsigned bits = size >= 4 ? 0xf : ((1u << size) - 1) << (address & 3);
    if ((w.allocated & bits) != bits) return fault(t, how, "access outside a buffer", place(p + i));
    const bool race = !t->block && size >= 4;
    const bool other_wrote = w.written_in == m.launch && w.writer != t->number, other_read = w.read_in == m.launch && w.reader != t->number;
    if (how == READS) {
      if ((w.written & bits) != bits) fault(t, how, "value that nobody wrote", place(p + i));
      if (race && other_wrote) fault(t, how, "race with a thread that wrote", "thread " + std::to_string(w.writer - 1) + ", " + place(p + i));
      w.reader = other_read ? kMany : t->number, w.read_in = m.launch;
    } else {
      if (race && how == WRITES && other_wrote)
        fault(t, how, "race with a thread that wrote", "thread " + std::to_string(w.writer - 1) + ", " + place(p + i));
      if (race && how == WRITES && other_read) fault(t, how, "race with a thread that read", place(p + i));
      w.written |= bits;
      if (size >= 4) w.writer = t->number, w.written_in = m.launch;
    }
  }
}

void ptx_check_shared(Thread* t, std::uint64_t address, std::uint32_t size) {
  const std::uint64_t offset = address - reinterpret_cast<std::uint64_t>(t->shared);
  if (offset + size > t->shared_bytes)
    fault(t, READS, "access outside shared memory", "byte " + std::to_string(offset) + " of " + std::to_string(t->shared_bytes));
  if (address % size != 0) fault(t, READS, "misaligned access to shared memory", "");
}

void ptx_check_local(Thread* t, std::uint64_t address, std::uint32_t size) {
  if (address < reinterpret_cast<std::uint64_t>(__builtin_frame_address(0)) || address + size > reinterpret_cast<std::uint64_t>(t->stack_end))
    fault(t, READS, "access outside local memory", "");
  if (address % size != 0) fault(t, READS, "misaligned access to local memory", "");
}
