#pragma once
// Tables of numbers from text files. The first line names the columns, separated by commas, each with its unit in brackets where it has one:
//     time [s], elbow [deg], grip [N]
// Every other line has one number per column; empty lines and those that begin with # say nothing.
#include <string>
#include <vector>

#include "base/error.h"

namespace mortise {

struct Csv {
  struct Column {
    std::string name, unit;  // unit: empty where none is written
    int place;               // character at which it begins in the header
    std::vector<double> values;
  };
  std::string path;
  int header = 0;          // line of the names
  std::vector<int> lines;  // of every row
  std::vector<Column> columns;

  // Throws Error(Exit::scene) where there is none, with the names that there are.
  const Column& column(const std::string& name) const;
  SourceLoc at(const Column& c) const { return {path, header, c.place}; }
};

// Throws Error(Exit::file) if it cannot be read, Error(Exit::scene) with line and column where it is no such table.
Csv read_csv(const std::string& path);

}  // namespace mortise
