// Rows of `mortise bench hard` against those of a committed result.
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "bench/hard/hard.h"

namespace mortise::bench::hard {
namespace {

std::string label(const std::string& name, const std::string& method, const std::string& variant) {
  return name + " " + method + (variant.empty() ? "" : " " + variant);
}

}  // namespace

std::vector<std::string> regressions(const std::vector<Row>& rows, const std::string& file, bool all) {
  std::ifstream in(file, std::ios::binary);
  const auto j = nlohmann::json::parse(std::string(std::istreambuf_iterator<char>(in), {}), nullptr, false);
  if (!in || !j.is_object() || !j.contains("rows")) throw Error(Exit::file, "'" + file + "' is not a result of `mortise bench hard --result`");
  std::map<std::string, nlohmann::json> before;
  for (const auto& r : j["rows"]) before[label(r["case"], r["method"], r["variant"])] = r;
  std::vector<std::string> out;
  for (const Row& row : rows) {
    const std::string name = label(row.name, row.method, row.variant);
    const auto it = before.find(name);
    if (!row.unsafe.empty()) out.push_back(name + ": " + row.unsafe);
    if (it == before.end()) {
      out.push_back(name + " is not in " + file);
      continue;
    }
    const bool slow = row.reason.starts_with("not done");  // says more about the machine than about the solver
    const bool grave = row.reason.starts_with("ended by signal") || row.reason.starts_with("min_det_f") || row.reason.starts_with("min_distance");
    if (!row.pass && !slow && it->second["pass"])
      out.push_back(name + ": passed before: " + row.reason);
    else if (grave && it->second["reason"] != row.reason)
      out.push_back(name + ": " + row.reason);
    before.erase(it);
  }
  if (all)
    for (const auto& [name, row] : before) out.push_back(name + " was not run");
  return out;
}

}  // namespace mortise::bench::hard
