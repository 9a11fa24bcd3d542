#pragma once
#include <string>
#include <vector>

namespace mortise {

// A column of numbers that a file holds, whatever its format.
struct Column {
  std::vector<double> values;
  std::string unit;  // "": none is written
  std::string at;    // what messages call it: "walk.h5: dataset 'hip'"
};

}  // namespace mortise
