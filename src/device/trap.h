#pragma once
// The debug device: the CPU backend with Buffers out of reach of everything but kernels and copies, as they are on a GPU.
//
//   * Buffers live in one range of addresses that is closed (mprotect) except while a kernel or a copy runs. Host code that
//     touches it ends the program with exit code 1 and a message that names the buffer and the last kernel.
//   * Every kernel's closure is searched for addresses: of host memory (a pointer, a reference, `this`, a std::vector) and of
//     released Buffers.
//   * Fresh memory, and memory that grows back into a Buffer, is filled with ones: NaN as a double, -1 as an Index. Released
//     memory too; it stays unused for a while, and a write into it, or behind the end of a Buffer, is reported at the latest
//     when it is used again or released.
//
// MORTISE_DEBUG_MEMORY_MIB limits the device's memory.
#include <cstddef>

namespace mortise::device::trap {

extern bool on;  // never reset

void start();  // throws Error(Exit::device) when the addresses cannot be reserved
std::size_t memory();

void* allocate(std::size_t bytes);
void release(void* p, std::size_t bytes);
bool owns(const void* p);
void forget(void* p, std::size_t bytes);
// Throws Error(Exit::internal) unless all of [p, p + bytes) belongs to one Buffer.
void check_range(const void* p, std::size_t bytes, const char* what);
// Throws Error(Exit::internal) when the closure holds an address that means nothing on a GPU.
void check_closure(const char* kernel, const void* closure, std::size_t bytes);

// Device memory is open while one of these exists.
class Open {
 public:
  explicit Open(const char* what) {
    if (on) open(what);
  }
  ~Open() {
    if (on) close();
  }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;

 private:
  static void open(const char* what);
  static void close();
};

}  // namespace mortise::device::trap
