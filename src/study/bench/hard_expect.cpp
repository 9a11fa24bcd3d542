// Rows of `mortise bench hard` against those of a committed result.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "study/bench/hard.h"

namespace mortise::study {
namespace {

struct Reason {
  std::string kind;  // the criterion, or "stops"
  double figure = NAN;
};

// "energy_gain below 1e-06: 0.057" is a criterion and a figure. A step that fails and a run that takes too long are of one kind: which
// comes first depends on the machine.
Reason parse(const std::string& text) {
  if (text.starts_with("exit code 5") || text.starts_with("not done")) return {"stops", NAN};
  const std::size_t colon = text.rfind(": ");
  if (colon == std::string::npos) return {text, NAN};
  char* end = nullptr;
  const double figure = std::strtod(text.c_str() + colon + 2, &end);
  return {text.substr(0, colon), *end == 0 ? figure : NAN};
}

// What is worse than before; "" if nothing.
std::string worse(const HardRow& now, bool passed, const std::string& reason) {
  if (now.pass) return "";
  if (passed) return "passed before: " + now.reason;
  const Reason a = parse(now.reason), b = parse(reason);
  if (a.kind != b.kind) return fmt::format("fails in another way: {} (before: {})", now.reason, reason);
  if (std::isfinite(b.figure) && !(std::abs(a.figure) <= 2 * std::abs(b.figure))) return fmt::format("{} (before: {:.4g})", now.reason, b.figure);
  return "";
}

std::string label(const std::string& name, const std::string& method, const std::string& variant) {
  return name + " " + method + (variant.empty() ? "" : " " + variant);
}

}  // namespace

std::vector<std::string> regressions(const std::vector<HardRow>& rows, const std::string& file, bool all) {
  std::ifstream in(file, std::ios::binary);
  const auto j = nlohmann::json::parse(std::string(std::istreambuf_iterator<char>(in), {}), nullptr, false);
  if (!in || !j.is_object() || !j.contains("rows")) throw Error(Exit::file, "'" + file + "' is not a result of `mortise bench hard --result`");
  std::map<std::string, nlohmann::json> before;
  for (const auto& r : j["rows"]) before[label(r["case"], r["method"], r["variant"])] = r;
  std::vector<std::string> out;
  for (const HardRow& row : rows) {
    const std::string name = label(row.name, row.method, row.variant);
    const auto it = before.find(name);
    if (!row.unsafe.empty()) out.push_back(name + ": " + row.unsafe);
    if (it == before.end()) {
      out.push_back(name + " is not in " + file);
      continue;
    }
    if (const std::string what = worse(row, it->second["pass"], it->second["reason"]); !what.empty()) out.push_back(name + ": " + what);
    before.erase(it);
  }
  if (all)
    for (const auto& [name, row] : before) out.push_back(name + " was not run");
  return out;
}

}  // namespace mortise::study
