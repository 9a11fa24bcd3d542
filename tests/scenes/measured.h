#pragma once
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

namespace mortise::testing {

// A figure that a README states: `test_scenes --gtest_output=xml` writes it down.
inline void measured(const std::string& what, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  ::testing::Test::RecordProperty(what, text);
}

}  // namespace mortise::testing
