#include <cstring>
#include <set>

#include "judge/judge.h"

namespace judge {
namespace {

herr_t note(hid_t, const char* name, const H5O_info_t* info, void* out) {
  if (info->type == H5O_TYPE_DATASET) static_cast<std::set<std::string>*>(out)->insert(name);
  return 0;
}

}  // namespace

std::string difference(const File& a, const File& b) {
  // Seconds and links to other files are no results; line searches and the like are.
  const std::set<std::string> timing{"mortise/steps/wall_ms"};
  std::set<std::string> names, others;
  H5Ovisit2(a.id(), H5_INDEX_NAME, H5_ITER_NATIVE, note, &names, H5O_INFO_BASIC);
  H5Ovisit2(b.id(), H5_INDEX_NAME, H5_ITER_NATIVE, note, &others, H5O_INFO_BASIC);
  for (const std::string& name : names)
    if (!others.count(name)) return name + " is in the first file only";
  for (const std::string& name : others)
    if (!names.count(name)) return name + " is in the second file only";
  for (const std::string& name : names) {
    if (timing.count(name) || !a.numeric(name)) continue;
    const std::vector<double> x = a.numbers(name), y = b.numbers(name);
    if (x.size() != y.size()) return name + " has " + std::to_string(x.size()) + " and " + std::to_string(y.size()) + " values";
    if (!x.empty() && std::memcmp(x.data(), y.data(), x.size() * sizeof(double)) != 0) return name + " differs";
  }
  return "";
}

}  // namespace judge
