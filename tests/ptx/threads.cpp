#include "threads.h"

#include <sys/mman.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "memory.h"
#include "report.h"

// Saves the registers that a call keeps and the stack pointer, and goes on where `to` was saved (x86-64 System V).
extern "C" void ptx_switch(void** saved, void* to);
asm(R"(
.text
.globl ptx_switch
.hidden ptx_switch
ptx_switch:
  pushq %rbp; pushq %rbx; pushq %r12; pushq %r13; pushq %r14; pushq %r15
  movq %rsp, (%rdi)
  movq %rsi, %rsp
  popq %r15; popq %r14; popq %r13; popq %r12; popq %rbx; popq %rbp
  ret
)");

namespace {

enum Meeting { kSync, kAll, kAny, kUniform, kBallot, kMatch, kShuffle };
constexpr std::size_t kStack = std::size_t{256} << 10;
constexpr long kPatience = 1'000'000;  // rounds in which every thread of a block waits

// What a lane brought to a meeting of its warp, and what it takes away.
struct Lane {
  bool waits = false;
  int meeting = 0;
  std::uint32_t mask = 0;
  std::uint64_t value = 0;
  std::uint32_t lane = 0, clamp = 0;
  std::uint32_t result = 0;
  std::uint8_t inside = 0;
};

}  // namespace

// Threads that meet run as fibers: each until it has to wait for others.
struct Block {
  std::vector<Thread> threads;
  std::vector<Lane> lanes;
  std::vector<void*> stack_pointer;
  std::vector<char> done;
  void* scheduler = nullptr;
  std::uint8_t* parameters = nullptr;
  Thread* starting = nullptr;
  std::uint32_t alive = 0, arrived = 0, brought = 0, counted = 0;
  std::uint64_t barriers = 0, progress = 0;
};

namespace {

using namespace ptx;

Block* running = nullptr;

void yield(Thread* t) { ptx_switch(&t->block->stack_pointer[t->linear], t->block->scheduler); }

void pass_barrier(Block& b) {
  b.counted = b.brought;
  b.arrived = b.brought = 0;
  ++b.barriers, ++b.progress;
}

void fiber() {
  Block& b = *running;
  Thread* t = b.starting;
  t->kernel->run(t, b.parameters);
  b.done[t->linear] = 1;
  --b.alive, ++b.progress;
  if (b.alive > 0 && b.arrived == b.alive) pass_barrier(b);
  for (;;) yield(t);
}

char* stacks() {
  static void* all = mmap(nullptr, kStack * 1024, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  return static_cast<char*>(all);
}

void run_together(Block& b) {
  const auto n = static_cast<std::uint32_t>(b.threads.size());
  running = &b;
  b.alive = n, b.arrived = b.brought = 0;
  b.lanes.assign((n + 31) / 32 * 32, {});
  b.done.assign(n, 0);
  b.stack_pointer.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    auto* top = reinterpret_cast<void**>(stacks() + kStack * (i + 1)) - 1;  // as a call leaves it: 8 beside a multiple of 16
    b.threads[i].stack_end = reinterpret_cast<std::uint8_t*>(top);
    *top = nullptr;  // where fiber() would return to
    *--top = reinterpret_cast<void*>(fiber);
    for (int saved = 0; saved < 6; ++saved) *--top = nullptr;
    b.stack_pointer[i] = top;
  }
  for (long idle = 0; b.alive > 0; ++idle) {
    const std::uint64_t before = b.progress;
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t i = settings().backwards ? n - 1 - k : k;
      b.starting = &b.threads[i];
      if (!b.done[i]) ptx_switch(&b.scheduler, b.stack_pointer[i]);
    }
    if (b.progress != before) idle = 0;
    if (idle > kPatience) {
      std::fprintf(stderr, "ptx: the threads of %s wait for each other\n", b.threads[0].kernel->name);
      std::abort();
    }
  }
}

// What every lane of the mask takes away once all are there.
void conclude(Lane* warp, std::uint32_t mask, int meeting) {
  std::uint32_t ballot = 0;
  for (std::uint32_t i = 0; i < 32; ++i)
    if (mask >> i & 1 && warp[i].waits) ballot |= (warp[i].value != 0 ? 1u : 0u) << i;
  for (std::uint32_t i = 0; i < 32; ++i) {
    Lane& l = warp[i];
    if (!(mask >> i & 1) || !l.waits) continue;
    if (meeting == kAll) l.result = ballot == mask;
    if (meeting == kAny) l.result = ballot != 0;
    if (meeting == kUniform) l.result = ballot == 0 || ballot == mask;
    if (meeting == kBallot) l.result = ballot;
    if (meeting == kMatch) {
      l.result = 0;
      for (std::uint32_t j = 0; j < 32; ++j)
        if (mask >> j & 1 && warp[j].value == l.value) l.result |= 1u << j;
    }
    if (meeting >= kShuffle) {  // PTX ISA, shfl.sync
      const std::uint32_t b = l.lane & 31, segment = l.clamp >> 8 & 31, most = (i & segment) | (l.clamp & 31 & ~segment);
      std::int64_t from = i;
      switch (meeting - kShuffle) {
        case SHFL_UP:
          from = std::int64_t{i} - b, l.inside = from >= most;
          break;
        case SHFL_DOWN:
          from = i + b, l.inside = from <= most;
          break;
        case SHFL_BFLY:
          from = i ^ b, l.inside = from <= most;
          break;
        default:
          from = (i & segment) | (b & ~segment), l.inside = from <= most;
      }
      if (!l.inside) from = i;
      if (!(mask >> from & 1)) report("a shuffle reads a lane outside its mask");
      l.result = static_cast<std::uint32_t>(warp[from].value);
    }
  }
  for (std::uint32_t i = 0; i < 32; ++i)
    if (mask >> i & 1) warp[i].waits = false;
}

Lane& meet(Thread* t, int meeting, std::uint32_t mask, std::uint64_t value, std::uint32_t lane = 0, std::uint32_t clamp = 0) {
  Block& b = *t->block;
  Lane* warp = &b.lanes[t->linear & ~31u];
  Lane& me = warp[t->lane];
  me = {true, meeting, mask, value, lane, clamp};
  if (!(mask >> t->lane & 1)) {
    report("a lane outside the mask takes part", t->kernel->name);
    me.waits = false, me.result = static_cast<std::uint32_t>(value);
    return me;
  }
  bool all = true;
  for (std::uint32_t i = 0; i < 32; ++i) {
    if (!(mask >> i & 1)) continue;
    const std::uint32_t there = (t->linear & ~31u) + i;
    if (there >= b.done.size() || b.done[there]) {
      report("the mask names a lane that is not there", t->kernel->name);
      continue;
    }
    all = all && warp[i].waits && warp[i].mask == mask && warp[i].meeting == meeting;
  }
  if (all) {
    conclude(warp, mask, meeting);
    ++b.progress;
  }
  while (me.waits) yield(t);
  return me;
}

}  // namespace

std::uint32_t ptx_barrier(Thread* t, int predicate) {
  Block& b = *t->block;
  const std::uint64_t before = b.barriers;
  b.brought += predicate != 0;
  if (++b.arrived == b.alive) pass_barrier(b);
  while (b.barriers == before) yield(t);
  return b.counted;
}
std::uint32_t ptx_block_threads(Thread* t) { return t->block->alive; }
void ptx_wait(Thread* t) { yield(t); }
void ptx_warp_sync(Thread* t, std::uint32_t mask) { meet(t, kSync, mask, 0); }
int ptx_vote_all(Thread* t, int p, std::uint32_t mask) { return static_cast<int>(meet(t, kAll, mask, p != 0).result); }
int ptx_vote_any(Thread* t, int p, std::uint32_t mask) { return static_cast<int>(meet(t, kAny, mask, p != 0).result); }
int ptx_vote_uni(Thread* t, int p, std::uint32_t mask) { return static_cast<int>(meet(t, kUniform, mask, p != 0).result); }
std::uint32_t ptx_vote_ballot(Thread* t, int p, std::uint32_t mask) { return meet(t, kBallot, mask, p != 0).result; }
std::uint32_t ptx_match_any(Thread* t, std::uint64_t value, std::uint32_t mask) { return meet(t, kMatch, mask, value).result; }
std::uint32_t ptx_shfl(Thread* t, Shuffle mode, std::uint32_t value, std::uint32_t lane, std::uint32_t clamp, std::uint32_t mask,
                       std::uint8_t* inside) {
  const Lane& l = meet(t, kShuffle + static_cast<int>(mode), mask, value, lane, clamp);
  *inside = l.inside;
  return l.result;
}
void ptx_trap(Thread* t) {
  std::fprintf(stderr, "ptx: trap in %s, thread %u\n", t->kernel->name, t->number - 1);
  std::abort();
}

void ptx::run(Launch& l) {
  next_launch();
  const std::uint32_t per_block = l.block[0] * l.block[1] * l.block[2], blocks = l.grid[0] * l.grid[1] * l.grid[2];
  std::vector<std::uint64_t> shared((l.kernel->shared_bytes + l.dynamic_shared + 15) / 16 * 2 + 2);
  const auto thread = [&](std::uint32_t block, std::uint32_t i) {
    const auto at = [](std::uint32_t n, const std::uint32_t* size, int axis) {
      return axis == 0 ? n % size[0] : axis == 1 ? n / size[0] % size[1] : n / size[0] / size[1];
    };
    Thread t{};
    for (int a = 0; a < 3; ++a) t.tid[a] = at(i, l.block, a), t.ntid[a] = l.block[a], t.ctaid[a] = at(block, l.grid, a), t.nctaid[a] = l.grid[a];
    t.linear = i, t.lane = i % 32, t.number = block * per_block + i + 1;
    t.shared = reinterpret_cast<std::uint8_t*>((reinterpret_cast<std::uintptr_t>(shared.data()) + 15) / 16 * 16);
    t.shared_bytes = l.kernel->shared_bytes + l.dynamic_shared;
    t.kernel = l.kernel;
    t.stack_end = static_cast<std::uint8_t*>(__builtin_frame_address(0));
    return t;
  };
  if (!l.kernel->meets) {
    const std::uint64_t all = std::uint64_t{per_block} * blocks;
    for (std::uint64_t k = 0; k < all; ++k) {
      const std::uint64_t n = settings().backwards ? all - 1 - k : k;
      Thread t = thread(static_cast<std::uint32_t>(n / per_block), static_cast<std::uint32_t>(n % per_block));
      l.kernel->run(&t, l.parameters.data());
    }
    return count_run(l.kernel, all, traffic());
  }
  Block b;
  b.parameters = l.parameters.data();
  for (std::uint32_t block = 0; block < blocks; ++block) {  // in this order always: later blocks may wait for earlier ones
    b.threads.clear();
    for (std::uint32_t i = 0; i < per_block; ++i) b.threads.push_back(thread(block, i));
    for (Thread& t : b.threads) t.block = &b;
    run_together(b);
  }
  count_run(l.kernel, std::size_t{per_block} * blocks, traffic());
}
