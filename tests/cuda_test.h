#pragma once
// Included in front of every test that nvcc compiles: the body of a TEST is a function of its own, because kernels must not
// stand in private member functions, which is what GoogleTest makes of it.
#define GTEST_DONT_DEFINE_TEST 1
#include <gtest/gtest.h>
#define TEST(suite, name)                                                                                      \
  static void suite##_##name##_body();                                                                         \
  GTEST_TEST_(suite, name, ::testing::Test, ::testing::internal::GetTestTypeId()) { suite##_##name##_body(); } \
  static void suite##_##name##_body()
