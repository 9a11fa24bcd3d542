#pragma once
// Philox4x32-10, a counter-based generator: a bijection of 128 bits that depends on a 64-bit key, so that number n of a stream is found without
// the numbers before it (Salmon, Moraes, Dror, Shaw: Parallel Random Numbers: As Easy as 1, 2, 3. SC 2011).
#include <array>
#include <cstdint>
#include <string_view>

namespace mortise {

using Philox = std::array<std::uint32_t, 4>;

constexpr Philox philox(Philox counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0], b = std::uint64_t{0xCD9E8D57} * counter[2];
    counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
               static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
    key[0] += 0x9E3779B9, key[1] += 0xBB67AE85;
  }
  return counter;
}

// The stream of random numbers of one parameter: two independent numbers in (0, 1) for every index, from the seed and the parameter's name alone.
class Stream {
 public:
  constexpr Stream(std::uint64_t seed, std::string_view name) : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)} {
    for (char c : name) name_ = (name_ ^ static_cast<unsigned char>(c)) * 0x100000001b3;  // FNV-1a
  }
  constexpr std::array<double, 2> at(std::uint64_t index) const {
    const Philox r = philox({static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32), static_cast<std::uint32_t>(name_),
                             static_cast<std::uint32_t>(name_ >> 32)},
                            key_);
    const auto unit = [](std::uint32_t hi, std::uint32_t lo) { return (static_cast<double>((std::uint64_t{hi} << 32 | lo) >> 12) + 0.5) * 0x1p-52; };
    return {unit(r[0], r[1]), unit(r[2], r[3])};
  }

 private:
  std::array<std::uint32_t, 2> key_;
  std::uint64_t name_ = 0xcbf29ce484222325;
};

}  // namespace mortise
