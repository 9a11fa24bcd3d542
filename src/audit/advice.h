#pragma once
#include <string_view>

namespace mortise::audit {

// What makes the estimate of a check (certificate_grade.cpp) smaller, in the keys of a scene; empty where there is none.
std::string_view advice(std::string_view check);

}  // namespace mortise::audit
