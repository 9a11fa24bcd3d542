#pragma once
#include <string>
#include <string_view>

namespace mortise::audit {

// What a scene has already, and need not be told.
struct Has {
  bool bdf2 = false, quadratic = false;  // all its soft bodies are
  double d_hat = 0;                      // the largest of its contact effects, 0 without [m]
};

// What makes the estimate of a check (certificate_grade.cpp) smaller, in the keys of a scene; empty where there is none.
std::string advice(std::string_view check, const Has& has = {});

}  // namespace mortise::audit
