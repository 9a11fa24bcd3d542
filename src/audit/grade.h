#pragma once
#include <map>
#include <string>
#include <vector>

#include "audit/advice.h"

namespace mortise::audit {

// What a check is about: all results, what is summed or goes as a whole (forces, torques, travels), or stresses and pressures point by point.
enum class Of { all, forces, fields };

// One quantity with two bounds: what a run is graded by.
struct Check {
  std::string name;
  double value, good, usable;
  Of of = Of::all;
  const char* earns() const { return value <= good ? "A" : (value <= usable ? "B" : "C"); }
};

// Sums forgive what fields do not: a coarse mesh has its forces right long before its stresses, so that forces have a grade of their own.
struct Grade {
  struct Verdict {
    std::string letter, reason;  // the first reason
    void lower(const char* to, const std::string& why);
  };
  Verdict all, forces;                   // forces: of the checks that are not of fields
  std::map<std::string, double> graded;  // what they rest on
  std::vector<Check> failed{};           // those that earn no A
  Has has{};
};

// "grade A", "grade B: REASON"; of forces as well where that is another one.
std::string text_of(const Grade& grade);
// "stress_error, stiffness_error: a finer mesh ..." (advice.h), of all checks that would have to be better for a better grade.
std::vector<std::string> hints(const Grade& grade);

}  // namespace mortise::audit
