#pragma once
// What C made of PTX (translate.py) is written against: one thread of a launch, checked memory, PTX arithmetic that C lacks.
#include <stdint.h>
#include <string.h>

typedef struct Thread {
  uint32_t tid[3], ntid[3], ctaid[3], nctaid[3];
  uint32_t linear, lane;  // in the block, in the warp
  uint32_t number;        // in the launch, from 1
  uint8_t* shared;
  uint32_t shared_bytes;
  const struct Kernel* kernel;
  const uint8_t *parameters, *stack_end;
  struct Block* block;  // of kernels whose threads meet, else null
} Thread;

typedef struct Kernel {
  const char* name;
  void (*run)(Thread*, uint8_t* parameters);
  int meets;  // has barriers, votes or shuffles
  uint32_t shared_bytes, most_threads;
  int architecture, parameter_count;
  struct {
    uint32_t offset, size;
  } parameter[32];
} Kernel;

enum Access { READS, WRITES, SHARES };  // the last: atomic
enum Shuffle { SHFL_UP, SHFL_DOWN, SHFL_BFLY, SHFL_IDX };

#ifdef __cplusplus
extern "C" {
#endif
extern int ptx_checked;  // MORTISE_PTX_CHECK
void ptx_know(const Kernel*, int count);
void ptx_check(Thread*, uint64_t address, uint32_t size, enum Access);
void ptx_check_shared(Thread*, uint64_t address, uint32_t size);
void ptx_check_local(Thread*, uint64_t address, uint32_t size);
void ptx_trap(Thread*);
uint32_t ptx_barrier(Thread*, int predicate);  // how many brought true
uint32_t ptx_block_threads(Thread*);
void ptx_wait(Thread*);
void ptx_warp_sync(Thread*, uint32_t mask);
int ptx_vote_all(Thread*, int, uint32_t mask);
int ptx_vote_any(Thread*, int, uint32_t mask);
int ptx_vote_uni(Thread*, int, uint32_t mask);
uint32_t ptx_vote_ballot(Thread*, int, uint32_t mask);
uint32_t ptx_match_any(Thread*, uint64_t value, uint32_t mask);
uint32_t ptx_shfl(Thread*, enum Shuffle, uint32_t value, uint32_t lane, uint32_t clamp, uint32_t mask, uint8_t* inside);
#ifdef __cplusplus
}
#else

#define CHECK(a, n, how) \
  if (__builtin_expect(ptx_checked, 0)) ptx_check(t, a, n, how)
#define CHECK_SHARED(a, n, how) \
  if (__builtin_expect(ptx_checked, 0)) ptx_check_shared(t, a, n)
#define CHECK_LOCAL(a, n, how) \
  if (__builtin_expect(ptx_checked, 0)) ptx_check_local(t, a, n)
#define TABLE __attribute__((section("ptx_tables"), aligned(16)))  // variables of the module
// NaN as a double, -1 as an integer: so that a local variable that is read before it is written shows.
#define UNWRITTEN(array) \
  if (__builtin_expect(ptx_checked, 0)) memset(array, 0xff, sizeof array)

static inline float f32_of(uint32_t b) {
  float x;
  memcpy(&x, &b, 4);
  return x;
}
static inline double f64_of(uint64_t b) {
  double x;
  memcpy(&x, &b, 8);
  return x;
}
static inline uint32_t bits_of_f32(float x) {
  uint32_t b;
  memcpy(&b, &x, 4);
  return b;
}
static inline uint64_t bits_of_f64(double x) {
  uint64_t b;
  memcpy(&b, &x, 8);
  return b;
}

// Division by zero is undefined in PTX; a GPU gives all ones.
#define DIVISION(T, name)                                                                                                  \
  static inline T div_##name(T a, T b) { return b == 0 ? (T)-1 : (T)-1 < 0 && b == (T)-1 ? (T)(0 - (uint64_t)a) : a / b; } \
  static inline T rem_##name(T a, T b) { return b == 0 ? a : (T)-1 < 0 && b == (T)-1 ? 0 : a % b; }
DIVISION(int16_t, s16)
DIVISION(uint16_t, u16)
DIVISION(int32_t, s32)
DIVISION(uint32_t, u32)
DIVISION(int64_t, s64)
DIVISION(uint64_t, u64)

// Saturating; NaN becomes 0.
#define TO_INTEGER(T, name, low, high) \
  static inline T to_##name(double x) { return x != x ? 0 : x <= (double)low ? low : x >= (double)high ? high : (T)x; }
TO_INTEGER(int8_t, s8, INT8_MIN, INT8_MAX)
TO_INTEGER(int16_t, s16, INT16_MIN, INT16_MAX)
TO_INTEGER(int32_t, s32, INT32_MIN, INT32_MAX)
TO_INTEGER(int64_t, s64, INT64_MIN, INT64_MAX)
TO_INTEGER(uint8_t, u8, 0, UINT8_MAX)
TO_INTEGER(uint16_t, u16, 0, UINT16_MAX)
TO_INTEGER(uint32_t, u32, 0, UINT32_MAX)
TO_INTEGER(uint64_t, u64, 0, UINT64_MAX)

static inline double upper_word(double x) { return f64_of(bits_of_f64(x) & 0xffffffff00000000ull); }
static inline double saturate(double x) { return !(x > 0) ? 0 : x > 1 ? 1 : x; }
static inline double min_float(double a, double b) { return a != a ? b : b != b ? a : a == b ? (__builtin_signbit(a) ? a : b) : a < b ? a : b; }
static inline double max_float(double a, double b) { return a != a ? b : b != b ? a : a == b ? (__builtin_signbit(a) ? b : a) : a > b ? a : b; }

static inline uint32_t popc32(uint32_t x) { return __builtin_popcount(x); }
static inline uint32_t popc64(uint64_t x) { return __builtin_popcountll(x); }
static inline uint32_t clz32(uint32_t x) { return x ? __builtin_clz(x) : 32; }
static inline uint32_t clz64(uint64_t x) { return x ? __builtin_clzll(x) : 64; }
static inline uint32_t brev32(uint32_t x) {
  uint32_t r = 0;
  for (int i = 0; i < 32; ++i) r |= (x >> i & 1u) << (31 - i);
  return r;
}
static inline uint64_t brev64(uint64_t x) { return (uint64_t)brev32((uint32_t)x) << 32 | brev32((uint32_t)(x >> 32)); }

// Fields of `count` bits from bit `first` on; both are bytes.
static inline uint64_t field(uint32_t count) { return count >= 64 ? ~0ull : (1ull << count) - 1; }
static inline uint64_t bfe64(uint64_t a, uint32_t first, uint32_t count) { return (first & 255) > 63 ? 0 : a >> (first & 255) & field(count & 255); }
static inline uint32_t bfe32(uint32_t a, uint32_t first, uint32_t count) { return (uint32_t)bfe64(a, first, count); }
static inline uint64_t bfi64(uint64_t a, uint64_t b, uint32_t first, uint32_t count) {
  const uint64_t m = (first & 255) > 63 ? 0 : field(count & 255) << (first & 255);
  return (b & ~m) | ((first & 255) > 63 ? 0 : a << (first & 255) & m);
}
static inline uint32_t bfi32(uint32_t a, uint32_t b, uint32_t first, uint32_t count) { return (uint32_t)bfi64(a, b, first, count); }

static inline uint32_t prmt(uint32_t a, uint32_t b, uint32_t selection) {
  const uint64_t both = (uint64_t)b << 32 | a;
  uint32_t r = 0;
  for (int i = 0; i < 4; ++i) {
    const uint32_t s = selection >> 4 * i & 15, byte = (uint32_t)(both >> 8 * (s & 7)) & 255;
    r |= (s & 8 ? (byte & 128 ? 255u : 0u) : byte) << 8 * i;
  }
  return r;
}
static inline uint32_t lop3(uint32_t a, uint32_t b, uint32_t c, uint32_t table) {
  uint32_t r = 0;
  for (int i = 0; i < 8; ++i)
    if (table >> i & 1) r |= (i & 4 ? a : ~a) & (i & 2 ? b : ~b) & (i & 1 ? c : ~c);
  return r;
}
#endif
