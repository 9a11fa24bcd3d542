#pragma once
// What generators of random scenes share.
#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <random>
#include <string>

namespace mortise::bench::hard {

// The distributions of <random> differ between libraries; a seed must give the same scene everywhere.
class Dice {
 public:
  explicit Dice(unsigned long seed) : bits_(seed * 0x9e3779b97f4a7c15ull + 1) {}
  double in(double lo, double hi) { return lo + (hi - lo) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double power(double lo, double hi) { return std::pow(10.0, in(lo, hi)); }
  bool chance(double p) { return in(0, 1) < p; }
  int below(int n) { return static_cast<int>(in(0, n)); }

 private:
  std::mt19937_64 bits_;
};

inline std::string num(double v) { return fmt::format("{:.6g}", v); }
inline YAML::Node vec(double x, double y, double z) { return YAML::Load(fmt::format("[{}, {}, {}]", num(x), num(y), num(z))); }

// Scales of the scene: lengths L, times sqrt(L/g), speeds sqrt(g L).
struct Scales {
  double L, g = 9.81;
  double time() const { return std::sqrt(L / g); }
  double speed() const { return std::sqrt(g * L); }
};

inline std::string emit(const YAML::Node& node) {
  YAML::Emitter out;
  out << node;
  return std::string(out.c_str()) + "\n";
}

}  // namespace mortise::bench::hard
