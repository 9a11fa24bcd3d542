// Every PTX instruction against g++: the same values go through the instruction on the emulated device and through an expression on the
// host, and the results must have the same bits (any NaN is as good as another).
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

namespace {

using u16 = std::uint16_t;
using s16 = std::int16_t;
using u32 = std::uint32_t;
using s32 = std::int32_t;
using u64 = std::uint64_t;
using s64 = std::int64_t;
using f32 = float;
using f64 = double;

// Registers of inline assembly by type.
#define REG_u16 "h"
#define REG_s16 "h"
#define REG_u32 "r"
#define REG_s32 "r"
#define REG_u64 "l"
#define REG_s64 "l"
#define REG_f32 "f"
#define REG_f64 "d"

template <class T>
std::vector<T> samples() {
  std::vector<T> out;
  if constexpr (std::is_floating_point_v<T>) {
    using L = std::numeric_limits<T>;
    out = {0,
           -T(0),
           1,
           -1,
           T(0.5),
           T(-1.5),
           T(2.5),
           3,
           L::infinity(),
           -L::infinity(),
           L::quiet_NaN(),
           L::max(),
           L::lowest(),
           L::min(),
           L::denorm_min(),
           L::epsilon(),
           T(1e9),
           T(-1e10),
           T(1) / 3};
  } else {
    using L = std::numeric_limits<T>;
    out = {0,
           1,
           2,
           3,
           5,
           8,
           15,
           31,
           32,
           33,
           63,
           64,
           255,
           T(-1),
           T(-2),
           T(-7),
           L::max(),
           L::min(),
           T(L::max() - 1),
           T(L::min() + 1),
           T(L::max() / 3),
           T(0x89abcdef01234567ull)};
  }
  std::mt19937_64 random(7);
  for (int k = 0; k < 6; ++k) {
    if constexpr (std::is_floating_point_v<T>)
      out.push_back(std::ldexp(T(random()) / T(~0ull) - T(0.5), static_cast<int>(random() % 40) - 20));
    else
      out.push_back(static_cast<T>(random()));
  }
  return out;
}

template <class T>
bool same(T a, T b) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(a) && std::isnan(b)) return true;
    return std::bit_cast<std::conditional_t<sizeof(T) == 8, u64, u32>>(a) == std::bit_cast<std::conditional_t<sizeof(T) == 8, u64, u32>>(b);
  } else {
    return a == b;
  }
}

template <class T>
T* upload(const std::vector<T>& host) {
  void* p = nullptr;
  EXPECT_EQ(cudaMallocAsync(&p, host.size() * sizeof(T), nullptr), cudaSuccess);
  EXPECT_EQ(cudaMemcpy(p, host.data(), host.size() * sizeof(T), cudaMemcpyHostToDevice), cudaSuccess);
  return static_cast<T*>(p);
}

template <class R, class A, class B, class C, class Host>
void compare(const char* name, void (*kernel)(const A*, const B*, const C*, R*, int), Host host) {
  std::vector<A> a;
  std::vector<B> b;
  std::vector<C> c;
  for (A x : samples<A>())
    for (B y : samples<B>())
      for (C z : samples<C>()) a.push_back(x), b.push_back(y), c.push_back(z);
  const int n = static_cast<int>(a.size());
  std::vector<R> result(n);
  A* da = upload(a);
  B* db = upload(b);
  C* dc = upload(c);
  R* out = upload(result);
  kernel<<<(n + 127) / 128, 128>>>(da, db, dc, out, n);
  ASSERT_EQ(cudaMemcpy(result.data(), out, n * sizeof(R), cudaMemcpyDeviceToHost), cudaSuccess);
  int wrong = 0;
  for (int i = 0; i < n && wrong < 5; ++i) {
    const R expected = host(a[i], b[i], c[i]);
    if (same(result[i], expected)) continue;
    ++wrong;
    ADD_FAILURE() << name << " of " << a[i] << ", " << b[i] << ", " << c[i] << " gives " << result[i] << ", not " << expected;
  }
  for (void* p : {static_cast<void*>(da), static_cast<void*>(db), static_cast<void*>(dc), static_cast<void*>(out)}) cudaFreeAsync(p, nullptr);
}

// OPCODE(name, type of the result, types of a, b and c, assembly with %0 = result and %1, %2, %3 = a, b, c, the same for g++)
#define OPCODE(name, R, A, B, C, text, ...)                                                                                                  \
  __global__ void k_##name(const A* a, const B* b, const C* c, R* out, int n) {                                                              \
    const int i = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);                                                                   \
    if (i >= n) return;                                                                                                                      \
    R r;                                                                                                                                     \
    asm volatile(text : "=" REG_##R(r) : REG_##A(a[i]), REG_##B(b[i]), REG_##C(c[i]));                                                       \
    out[i] = r;                                                                                                                              \
  }                                                                                                                                          \
  TEST(Opcode, name) {                                                                                                                       \
    compare<R, A, B, C>(#name, k_##name, []([[maybe_unused]] A a, [[maybe_unused]] B b, [[maybe_unused]] C c) -> R { return __VA_ARGS__; }); \
  }
#define PREDICATE(name, A, instruction, expression) \
  OPCODE(name, u32, A, A, u32, "{ .reg .pred p; " instruction " p, %1, %2; selp.b32 %0, 1, 0, p; }", (expression) ? 1 : 0)

// --- integers ---
OPCODE(add_s32, s32, s32, s32, u16, "add.s32 %0, %1, %2;", static_cast<s32>(u32(a) + u32(b)))
OPCODE(add_s64, s64, s64, s64, u16, "add.s64 %0, %1, %2;", static_cast<s64>(u64(a) + u64(b)))
OPCODE(add_s16, s16, s16, s16, u16, "add.s16 %0, %1, %2;", static_cast<s16>(a + b))
OPCODE(sub_s32, s32, s32, s32, u16, "sub.s32 %0, %1, %2;", static_cast<s32>(u32(a) - u32(b)))
OPCODE(sub_s16, s16, s16, s16, u16, "sub.s16 %0, %1, %2;", static_cast<s16>(a - b))
OPCODE(sub_s64, s64, s64, s64, u16, "sub.s64 %0, %1, %2;", static_cast<s64>(u64(a) - u64(b)))
OPCODE(mul_lo_s32, s32, s32, s32, u16, "mul.lo.s32 %0, %1, %2;", static_cast<s32>(u32(a) * u32(b)))
OPCODE(mul_lo_s16, s16, s16, s16, u16, "mul.lo.s16 %0, %1, %2;", static_cast<s16>(a* b))
OPCODE(mul_lo_s64, s64, s64, s64, u16, "mul.lo.s64 %0, %1, %2;", static_cast<s64>(u64(a) * u64(b)))
OPCODE(mul_hi_s32, s32, s32, s32, u16, "mul.hi.s32 %0, %1, %2;", static_cast<s32>((s64(a) * s64(b)) >> 32))
OPCODE(mul_hi_u32, u32, u32, u32, u16, "mul.hi.u32 %0, %1, %2;", static_cast<u32>((u64(a) * u64(b)) >> 32))
OPCODE(mul_hi_u64, u64, u64, u64, u16, "mul.hi.u64 %0, %1, %2;", static_cast<u64>((static_cast<unsigned __int128>(a) * b) >> 64))
OPCODE(mul_hi_s64, s64, s64, s64, u16, "mul.hi.s64 %0, %1, %2;", static_cast<s64>((static_cast<__int128>(a) * b) >> 64))
OPCODE(mul_wide_s32, s64, s32, s32, u16, "mul.wide.s32 %0, %1, %2;", s64(a) * s64(b))
OPCODE(mul_wide_u32, u64, u32, u32, u16, "mul.wide.u32 %0, %1, %2;", u64(a) * u64(b))
OPCODE(mul_wide_u16, u32, u16, u16, u16, "mul.wide.u16 %0, %1, %2;", u32(a) * u32(b))
OPCODE(mul_wide_s16, s32, s16, s16, u16, "mul.wide.s16 %0, %1, %2;", s32(a) * s32(b))
OPCODE(mad_lo_s32, s32, s32, s32, s32, "mad.lo.s32 %0, %1, %2, %3;", static_cast<s32>(u32(a) * u32(b) + u32(c)))
OPCODE(mad_hi_u32, u32, u32, u32, u32, "mad.hi.u32 %0, %1, %2, %3;", static_cast<u32>((u64(a) * u64(b)) >> 32) + c)
OPCODE(mad_wide_s32, s64, s32, s32, s64, "mad.wide.s32 %0, %1, %2, %3;", static_cast<s64>(u64(s64(a) * s64(b)) + u64(c)))
OPCODE(mad_lo_s64, s64, s64, s64, s64, "mad.lo.s64 %0, %1, %2, %3;", static_cast<s64>(u64(a) * u64(b) + u64(c)))
OPCODE(div_s32, s32, s32, s32, u16, "div.s32 %0, %1, %2;", b == 0 ? -1 : b == -1 ? static_cast<s32>(0 - u32(a)) : a / b)
OPCODE(div_u32, u32, u32, u32, u16, "div.u32 %0, %1, %2;", b == 0 ? ~0u : a / b)
OPCODE(div_u64, u64, u64, u64, u16, "div.u64 %0, %1, %2;", b == 0 ? ~0ull : a / b)
OPCODE(rem_s32, s32, s32, s32, u16, "rem.s32 %0, %1, %2;", b == 0 ? a : b == -1 ? 0 : a % b)
OPCODE(rem_u32, u32, u32, u32, u16, "rem.u32 %0, %1, %2;", b == 0 ? a : a % b)
OPCODE(rem_u64, u64, u64, u64, u16, "rem.u64 %0, %1, %2;", b == 0 ? a : a % b)
OPCODE(neg_s32, s32, s32, u16, u16, "neg.s32 %0, %1;", static_cast<s32>(0 - u32(a)))
OPCODE(neg_s64, s64, s64, u16, u16, "neg.s64 %0, %1;", static_cast<s64>(0 - u64(a)))
OPCODE(abs_s32, s32, s32, u16, u16, "abs.s32 %0, %1;", static_cast<s32>(a < 0 ? 0 - u32(a) : u32(a)))
OPCODE(abs_s64, s64, s64, u16, u16, "abs.s64 %0, %1;", static_cast<s64>(a < 0 ? 0 - u64(a) : u64(a)))
OPCODE(min_s32, s32, s32, s32, u16, "min.s32 %0, %1, %2;", a < b ? a : b)
OPCODE(max_s32, s32, s32, s32, u16, "max.s32 %0, %1, %2;", a > b ? a : b)
OPCODE(min_u32, u32, u32, u32, u16, "min.u32 %0, %1, %2;", a < b ? a : b)
OPCODE(max_u32, u32, u32, u32, u16, "max.u32 %0, %1, %2;", a > b ? a : b)
OPCODE(min_s64, s64, s64, s64, u16, "min.s64 %0, %1, %2;", a < b ? a : b)
#define UNPACK ".reg .u32 a0, a1, b0, b1, c0, c1, r0, r1; mov.b64 {a0, a1}, %1; mov.b64 {b0, b1}, %2; mov.b64 {c0, c1}, %3; "
OPCODE(add_carry, u64, u64, u64, u64, "{ " UNPACK "add.cc.u32 r0, a0, b0; addc.u32 r1, a1, b1; mov.b64 %0, {r0, r1}; }", a + b)
OPCODE(sub_carry, u64, u64, u64, u64, "{ " UNPACK "sub.cc.u32 r0, a0, b0; subc.u32 r1, a1, b1; mov.b64 %0, {r0, r1}; }", a - b)
OPCODE(carry_out, u64, u64, u64, u64, "{ " UNPACK "add.cc.u32 r0, a0, b0; addc.cc.u32 r1, a1, b1; addc.u32 r0, 0, 0; mov.b64 %0, {r0, r1}; }",
       u64(static_cast<u32>((a + b) >> 32)) << 32 | (a + b < a ? 1u : 0u))
OPCODE(mad_carry, u64, u64, u64, u64, "{ " UNPACK "mad.lo.cc.u32 r0, a0, b0, c0; madc.hi.u32 r1, a0, b0, c1; mov.b64 %0, {r0, r1}; }",
       u64(u32(a)) * u64(u32(b)) + c)
OPCODE(mad_chain, u64, u64, u64, u64,
       "{ " UNPACK "mad.lo.cc.u32 r0, a0, b0, c0; madc.hi.cc.u32 r1, a0, b0, c1; madc.lo.cc.u32 r1, a1, b1, r1; mov.b64 %0, {r0, r1}; }",
       [](u64 a, u64 b, u64 c) {
         const unsigned __int128 s = static_cast<unsigned __int128>(u64(u32(a)) * u64(u32(b))) + c;
         const u32 carry = static_cast<u32>(s >> 64), high = static_cast<u32>(u64(s) >> 32);
         return u64(static_cast<u32>(u32(a >> 32) * u32(b >> 32) + high + carry)) << 32 | u32(s);
       }(a, b, c))

// --- bits ---
OPCODE(and_b32, u32, u32, u32, u16, "and.b32 %0, %1, %2;", a& b)
OPCODE(and_b64, u64, u64, u64, u16, "and.b64 %0, %1, %2;", a& b)
OPCODE(or_b32, u32, u32, u32, u16, "or.b32 %0, %1, %2;", a | b)
OPCODE(or_b16, u16, u16, u16, u16, "or.b16 %0, %1, %2;", static_cast<u16>(a | b))
OPCODE(xor_b64, u64, u64, u64, u16, "xor.b64 %0, %1, %2;", a ^ b)
OPCODE(xor_b16, u16, u16, u16, u16, "xor.b16 %0, %1, %2;", static_cast<u16>(a ^ b))
OPCODE(not_b32, u32, u32, u16, u16, "not.b32 %0, %1;", ~a)
OPCODE(not_b64, u64, u64, u16, u16, "not.b64 %0, %1;", ~a)
OPCODE(cnot_b32, u32, u32, u16, u16, "cnot.b32 %0, %1;", a == 0 ? 1u : 0u)
OPCODE(shl_b32, u32, u32, u32, u16, "shl.b32 %0, %1, %2;", b >= 32 ? 0 : a << b)
OPCODE(shl_b64, u64, u64, u32, u16, "shl.b64 %0, %1, %2;", b >= 64 ? 0 : a << b)
OPCODE(shl_b16, u16, u16, u32, u16, "shl.b16 %0, %1, %2;", b >= 16 ? u16(0) : static_cast<u16>(a << b))
OPCODE(shr_u32, u32, u32, u32, u16, "shr.u32 %0, %1, %2;", b >= 32 ? 0 : a >> b)
OPCODE(shr_s32, s32, s32, u32, u16, "shr.s32 %0, %1, %2;", a >> (b >= 32 ? 31 : b))
OPCODE(shr_u64, u64, u64, u32, u16, "shr.u64 %0, %1, %2;", b >= 64 ? 0 : a >> b)
OPCODE(shr_s64, s64, s64, u32, u16, "shr.s64 %0, %1, %2;", a >> (b >= 64 ? 63 : b))
OPCODE(shr_b64, u64, u64, u32, u16, "shr.b64 %0, %1, %2;", b >= 64 ? 0 : a >> b)
OPCODE(shf_l_wrap, u32, u32, u32, u32, "shf.l.wrap.b32 %0, %1, %2, %3;", static_cast<u32>(((u64(b) << 32 | a) << (c & 31)) >> 32))
OPCODE(shf_r_wrap, u32, u32, u32, u32, "shf.r.wrap.b32 %0, %1, %2, %3;", static_cast<u32>((u64(b) << 32 | a) >> (c & 31)))
OPCODE(shf_r_clamp, u32, u32, u32, u32, "shf.r.clamp.b32 %0, %1, %2, %3;", static_cast<u32>((u64(b) << 32 | a) >> (c > 32 ? 32 : c)))
OPCODE(popc_b32, u32, u32, u16, u16, "popc.b32 %0, %1;", static_cast<u32>(std::popcount(a)))
OPCODE(popc_b64, u32, u64, u16, u16, "popc.b64 %0, %1;", static_cast<u32>(std::popcount(a)))
OPCODE(clz_b32, u32, u32, u16, u16, "clz.b32 %0, %1;", static_cast<u32>(std::countl_zero(a)))
OPCODE(clz_b64, u32, u64, u16, u16, "clz.b64 %0, %1;", static_cast<u32>(std::countl_zero(a)))
template <class T>
T reversed(T x) {
  T r = 0;
  for (unsigned i = 0; i < 8 * sizeof(T); ++i) r |= (x >> i & 1) << (8 * sizeof(T) - 1 - i);
  return r;
}
OPCODE(brev_b32, u32, u32, u16, u16, "brev.b32 %0, %1;", reversed(a))
OPCODE(brev_b64, u64, u64, u16, u16, "brev.b64 %0, %1;", reversed(a))
template <class T>
T bit_of(T x, unsigned i) {  // beyond the top: 0
  return i < 8 * sizeof(T) ? x >> i & 1 : 0;
}
template <class T>
T extracted(T a, u32 first, u32 count) {
  T r = 0;
  for (unsigned i = 0; i < (count & 255) && i < 8 * sizeof(T); ++i) r |= bit_of(a, (first & 255) + i) << i;
  return r;
}
template <class T>
T inserted(T a, T b, u32 first, u32 count) {
  for (unsigned i = 0; i < (count & 255) && (first & 255) + i < 8 * sizeof(T); ++i) {
    const T bit = T(1) << ((first & 255) + i);
    b = bit_of(a, i) ? b | bit : b & ~bit;
  }
  return b;
}
OPCODE(bfe_u32, u32, u32, u32, u32, "bfe.u32 %0, %1, %2, %3;", extracted(a, b, c))
OPCODE(bfe_u64, u64, u64, u32, u32, "bfe.u64 %0, %1, %2, %3;", extracted(a, b, c))
OPCODE(bfi_b32, u32, u32, u32, u32, "bfi.b32 %0, %1, %2, %3, 7;", inserted(a, b, c, 7))
OPCODE(bfi_b32_count, u32, u32, u32, u32, "bfi.b32 %0, %1, %2, 5, %3;", inserted(a, b, 5, c))
OPCODE(bfi_b64, u64, u64, u64, u32, "bfi.b64 %0, %1, %2, %3, 19;", inserted(a, b, c, 19))
OPCODE(prmt_b32, u32, u32, u32, u32, "prmt.b32 %0, %1, %2, %3;", [](u32 a, u32 b, u32 s) {
  std::uint8_t from[8], to[4];
  std::memcpy(from, &a, 4), std::memcpy(from + 4, &b, 4);
  for (int i = 0; i < 4; ++i) {
    const u32 k = s >> (4 * i);
    to[i] = k & 8 ? (from[k & 7] & 0x80 ? 0xff : 0) : from[k & 7];
  }
  u32 r;
  std::memcpy(&r, to, 4);
  return r;
}(a, b, c))
OPCODE(lop3_b32, u32, u32, u32, u32, "lop3.b32 %0, %1, %2, %3, 0xe4;", (a & c) | (b & ~c))
OPCODE(lop3_xor, u32, u32, u32, u32, "lop3.b32 %0, %1, %2, %3, 0x96;", a ^ b ^ c)

// --- floating point ---
OPCODE(add_f64, f64, f64, f64, u16, "add.rn.f64 %0, %1, %2;", a + b)
OPCODE(sub_f64, f64, f64, f64, u16, "sub.rn.f64 %0, %1, %2;", a - b)
OPCODE(mul_f64, f64, f64, f64, u16, "mul.rn.f64 %0, %1, %2;", a* b)
OPCODE(div_f64, f64, f64, f64, u16, "div.rn.f64 %0, %1, %2;", a / b)
OPCODE(fma_f64, f64, f64, f64, f64, "fma.rn.f64 %0, %1, %2, %3;", std::fma(a, b, c))
OPCODE(add_f32, f32, f32, f32, u16, "add.rn.f32 %0, %1, %2;", a + b)
OPCODE(mul_f32, f32, f32, f32, u16, "mul.rn.f32 %0, %1, %2;", a* b)
OPCODE(fma_f32, f32, f32, f32, f32, "fma.rn.f32 %0, %1, %2, %3;", std::fmaf(a, b, c))
OPCODE(sqrt_f64, f64, f64, u16, u16, "sqrt.rn.f64 %0, %1;", std::sqrt(a))
OPCODE(sqrt_f32, f32, f32, u16, u16, "sqrt.rn.f32 %0, %1;", std::sqrt(a))
OPCODE(rcp_f64, f64, f64, u16, u16, "rcp.rn.f64 %0, %1;", 1 / a)
f64 upper(f64 x) { return std::bit_cast<f64>(std::bit_cast<u64>(x) >> 32 << 32); }
OPCODE(rcp_approx, f64, f64, u16, u16, "rcp.approx.ftz.f64 %0, %1;", upper(1 / a))
OPCODE(rsqrt_approx, f64, f64, u16, u16, "rsqrt.approx.ftz.f64 %0, %1;", upper(1 / std::sqrt(a)))
OPCODE(neg_f64, f64, f64, u16, u16, "neg.f64 %0, %1;", -a)
OPCODE(abs_f64, f64, f64, u16, u16, "abs.f64 %0, %1;", std::fabs(a))
OPCODE(abs_f32, f32, f32, u16, u16, "abs.f32 %0, %1;", std::fabs(a))
template <class T>
T lesser(T a, T b) {
  return std::isnan(a) ? b : std::isnan(b) ? a : a == 0 && b == 0 ? (std::signbit(a) ? a : b) : std::fmin(a, b);
}
OPCODE(min_f64, f64, f64, f64, u16, "min.f64 %0, %1, %2;", lesser(a, b))
OPCODE(max_f64, f64, f64, f64, u16, "max.f64 %0, %1, %2;", -lesser(-a, -b))
OPCODE(min_f32, f32, f32, f32, u16, "min.f32 %0, %1, %2;", lesser(a, b))
OPCODE(copysign_f64, f64, f64, f64, u16, "copysign.f64 %0, %1, %2;", std::copysign(b, a))
#define TESTP(kind, expression) \
  OPCODE(testp_##kind, u32, f64, u16, u16, "{ .reg .pred p; testp." #kind ".f64 p, %1; selp.b32 %0, 1, 0, p; }", (expression) ? 1 : 0)
TESTP(finite, std::isfinite(a))
TESTP(infinite, std::isinf(a))
TESTP(number, !std::isnan(a))
TESTP(notanumber, std::isnan(a))

// --- comparisons: unordered ones are true with a NaN ---
PREDICATE(setp_eq_f64, f64, "setp.eq.f64", a == b)
PREDICATE(setp_ne_f64, f64, "setp.ne.f64", a<b || a> b)
PREDICATE(setp_lt_f64, f64, "setp.lt.f64", a < b)
PREDICATE(setp_le_f64, f64, "setp.le.f64", a <= b)
PREDICATE(setp_gt_f64, f64, "setp.gt.f64", a > b)
PREDICATE(setp_ge_f64, f64, "setp.ge.f64", a >= b)
PREDICATE(setp_equ_f64, f64, "setp.equ.f64", a == b || std::isnan(a) || std::isnan(b))
PREDICATE(setp_neu_f64, f64, "setp.neu.f64", a != b)
PREDICATE(setp_ltu_f64, f64, "setp.ltu.f64", !(a >= b))
PREDICATE(setp_leu_f64, f64, "setp.leu.f64", !(a > b))
PREDICATE(setp_gtu_f64, f64, "setp.gtu.f64", !(a <= b))
PREDICATE(setp_geu_f64, f64, "setp.geu.f64", !(a < b))
PREDICATE(setp_num_f64, f64, "setp.num.f64", !std::isnan(a) && !std::isnan(b))
PREDICATE(setp_nan_f64, f64, "setp.nan.f64", std::isnan(a) || std::isnan(b))
PREDICATE(setp_lt_f32, f32, "setp.lt.f32", a < b)
PREDICATE(setp_eq_s32, s32, "setp.eq.s32", a == b)
PREDICATE(setp_lt_s32, s32, "setp.lt.s32", a < b)
PREDICATE(setp_lt_u32, u32, "setp.lt.u32", a < b)
PREDICATE(setp_hi_u32, u32, "setp.hi.u32", a > b)
PREDICATE(setp_ge_s64, s64, "setp.ge.s64", a >= b)
PREDICATE(setp_ge_u64, u64, "setp.ge.u64", a >= b)
PREDICATE(setp_ne_s16, s16, "setp.ne.s16", a != b)
OPCODE(setp_two, u32, s32, s32, u32, "{ .reg .pred p, q; setp.lt.s32 p|q, %1, %2; selp.b32 %0, 1, 0, q; }", a < b ? 0u : 1u)
OPCODE(setp_and, u32, s32, s32, s32, "{ .reg .pred p, q; setp.lt.s32 q, %2, %3; setp.lt.and.s32 p, %1, %2, q; selp.b32 %0, 1, 0, p; }",
       a < b && b < c ? 1u : 0u)
OPCODE(predicates, u32, s32, s32, s32,
       "{ .reg .pred p, q, r; setp.lt.s32 p, %1, %2; setp.lt.s32 q, %2, %3; and.pred r, p, q; not.pred p, p; or.pred r, r, p; xor.pred r, r, q; "
       "mov.pred q, r; selp.u32 %0, 1, 0, q; }",
       ((a < b && b < c) || !(a < b)) != (b < c) ? 1u : 0u)
OPCODE(guards, u32, s32, s32, s32, "{ .reg .pred p; setp.lt.s32 p, %1, %2; mov.u32 %0, 1; @p mov.u32 %0, 2; @!p add.u32 %0, %0, 4; }",
       a < b ? 2u : 5u)
OPCODE(selp_f64, f64, f64, f64, s32, "{ .reg .pred p; setp.gt.s32 p, %3, 0; selp.f64 %0, %1, %2, p; }", c > 0 ? a : b)
OPCODE(selp_u16, u16, u16, u16, s32, "{ .reg .pred p; setp.gt.s32 p, %3, 0; selp.u16 %0, %1, %2, p; }", c > 0 ? a : b)

// --- conversions: to integers saturating, NaN to 0 ---
template <class T>
T rounded_to(f64 x) {
  using L = std::numeric_limits<T>;
  return std::isnan(x) ? T(0) : x <= static_cast<f64>(L::min()) ? L::min() : x >= static_cast<f64>(L::max()) ? L::max() : static_cast<T>(x);
}
OPCODE(cvt_s64_s32, s64, s32, u16, u16, "cvt.s64.s32 %0, %1;", s64(a))
OPCODE(cvt_u64_u32, u64, u32, u16, u16, "cvt.u64.u32 %0, %1;", u64(a))
OPCODE(cvt_u32_u64, u32, u64, u16, u16, "cvt.u32.u64 %0, %1;", static_cast<u32>(a))
OPCODE(cvt_u16_u32, u16, u32, u16, u16, "cvt.u16.u32 %0, %1;", static_cast<u16>(a))
OPCODE(cvt_s32_s16, s32, s16, u16, u16, "cvt.s32.s16 %0, %1;", s32(a))
OPCODE(cvt_s32_s8, s32, s32, u16, u16, "cvt.s32.s8 %0, %1;", s32(static_cast<std::int8_t>(a)))
OPCODE(cvt_f64_s32, f64, s32, u16, u16, "cvt.rn.f64.s32 %0, %1;", f64(a))
OPCODE(cvt_f64_u64, f64, u64, u16, u16, "cvt.rn.f64.u64 %0, %1;", f64(a))
OPCODE(cvt_f64_s64, f64, s64, u16, u16, "cvt.rn.f64.s64 %0, %1;", f64(a))
OPCODE(cvt_f64_f32, f64, f32, u16, u16, "cvt.f64.f32 %0, %1;", f64(a))
OPCODE(cvt_f32_f64, f32, f64, u16, u16, "cvt.rn.f32.f64 %0, %1;", f32(a))
OPCODE(cvt_rni_s32, s32, f64, u16, u16, "cvt.rni.s32.f64 %0, %1;", rounded_to<s32>(std::nearbyint(a)))
OPCODE(cvt_rzi_s32, s32, f64, u16, u16, "cvt.rzi.s32.f64 %0, %1;", rounded_to<s32>(std::trunc(a)))
OPCODE(cvt_rmi_s64, s64, f64, u16, u16, "cvt.rmi.s64.f64 %0, %1;", rounded_to<s64>(std::floor(a)))
OPCODE(cvt_rzi_u64, u64, f64, u16, u16, "cvt.rzi.u64.f64 %0, %1;", rounded_to<u64>(std::trunc(a)))
OPCODE(cvt_rpi_u32, u32, f64, u16, u16, "cvt.rpi.u32.f64 %0, %1;", rounded_to<u32>(std::ceil(a)))
OPCODE(cvt_rmi_f64, f64, f64, u16, u16, "cvt.rmi.f64.f64 %0, %1;", std::floor(a))
OPCODE(cvt_rpi_f64, f64, f64, u16, u16, "cvt.rpi.f64.f64 %0, %1;", std::ceil(a))
OPCODE(cvt_rzi_f64, f64, f64, u16, u16, "cvt.rzi.f64.f64 %0, %1;", std::trunc(a))
OPCODE(cvt_sat_f64, f64, f64, u16, u16, "cvt.sat.f64.f64 %0, %1;", !(a > 0) ? 0.0 : a > 1 ? 1.0 : a)
OPCODE(mov_bits, u64, f64, u16, u16, "mov.b64 %0, %1;", std::bit_cast<u64>(a))
OPCODE(mov_immediate, f64, u16, u16, u16, "mov.f64 %0, 0dC000000000000000;", -2.0)

}  // namespace
