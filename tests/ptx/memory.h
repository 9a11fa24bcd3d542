#pragma once
// The emulated device's memory: one range of addresses. In checked mode it is known of every byte whether it is allocated and written, and
// of every 4 bytes which thread of the launch wrote or read them last. (That the host stays away is what the debug device checks.)
#include <cstddef>
#include <string>

#include "report.h"

namespace ptx {

char* allocate(std::size_t bytes);  // null beyond settings().memory
bool release(void* p);              // false: not the start of a buffer
std::size_t in_use();

bool on_device(const void* p);
bool one_buffer(const void* p, std::size_t bytes);
std::string place(const void* p);  // "byte 80 of a buffer of 80 bytes"

void next_launch();  // accesses from now on do not race with those before
Traffic traffic();   // of this launch
void mark_written(void* p, std::size_t bytes);
void mark_copied(void* to, const void* from, std::size_t bytes);
std::size_t never_written(const void* p, std::size_t bytes);  // in stretches of 8 bytes at least: shorter ones may be padding

}  // namespace ptx
