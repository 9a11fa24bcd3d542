#pragma once
#include <array>
#include <cmath>

namespace judge {

using Vector = std::array<double, 3>;
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector& operator+=(Vector& a, const Vector& b) {
  for (int k = 0; k < 3; ++k) a[k] += b[k];
  return a;
}
inline Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double norm(const Vector& a) { return std::sqrt(dot(a, a)); }
inline Vector cross(const Vector& a, const Vector& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
inline double volume(const Vector& a, const Vector& b, const Vector& c, const Vector& d) { return dot(cross(b - a, c - a), d - a) / 6; }

}  // namespace judge
