#pragma once
#include <string_view>

namespace mortise::audit {

// What a scene has already, and need not be told.
struct Has {
  bool bdf2 = false, quadratic = false;  // all its soft bodies are
};

// What makes the estimate of a check (certificate_grade.cpp) smaller, in the keys of a scene; empty where there is none.
std::string_view advice(std::string_view check, const Has& has = {});

}  // namespace mortise::audit
