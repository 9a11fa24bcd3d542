#include "study/accuracy_budget.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "study/error_budget.h"
#include "study/tuning.h"

namespace mortise::study {

static nlohmann::json read_certificate(const std::string& path) {
  std::ifstream in(path);
  return nlohmann::json::parse(in, nullptr, false);
}

std::optional<std::vector<GoalBudget>> goal_budgets(const std::string& certificate, const std::vector<Quantity>& quantities) {
  const auto j = read_certificate(certificate);
  if (!j.is_object() || !j.contains("error_budget")) return {};
  std::vector<GoalBudget> out;
  for (const Quantity& q : quantities) {
    const auto& all = j["error_budget"];
    const auto entry = std::find_if(all.begin(), all.end(), [&](const auto& e) { return e["quantity"] == q.name; });
    if (entry == all.end() || !(*entry)["why_not"].get<std::string>().empty()) return {};
    GoalBudget b;
    for (const auto& part : (*entry)["parts"]) {
      const bool known = part["error"].is_number();
      if (part["source"] == kMeshPart) {
        if (!known && !part["why_not"].get<std::string>().starts_with(kNotReliable)) return {};
        b.mesh = known ? part["error"].get<double>() : INFINITY;
      }
      if (part["source"] == kGapPart && known) b.gap = part["error"];
    }
    out.push_back(b);
  }
  return out;
}

std::string doubt_of(const std::string& certificate, const std::vector<Quantity>& quantities) {
  const auto j = read_certificate(certificate);
  const bool fields = std::any_of(quantities.begin(), quantities.end(), [](const Quantity& q) { return q.value.find('/') == std::string::npos; });
  const std::string grade = fields ? "grade" : "grade_forces", reason = fields ? "reason" : "reason_forces";
  if (!j.is_object() || !j.contains(grade) || !j.contains(reason)) return {};
  const auto letter = j[grade].get<std::string>();
  return letter < "C" ? std::string() : letter + (fields ? ": " : " of forces and motions: ") + j[reason].get<std::string>();
}

bool budgets_tell(const std::vector<AutoKnob>& knobs) {
  return std::all_of(knobs.begin(), knobs.end(), [](const AutoKnob& k) { return k.mesh || k.layer; });
}

std::vector<Climb> climbs_of_budgets(const std::vector<AutoKnob>& knobs, const std::vector<GoalBudget>& budgets) {
  std::vector<double> mesh, gap;
  for (const GoalBudget& b : budgets) mesh.push_back(b.mesh), gap.push_back(b.gap);
  const bool layer = std::any_of(knobs.begin(), knobs.end(), [](const AutoKnob& k) { return k.layer; });
  std::vector<Climb> out;
  for (const AutoKnob& k : knobs) {
    Climb& c = out.emplace_back();
    c.name = k.name, c.ratio = k.ratio, c.dearer = k.dearer;
    if (k.mesh) c.parts.push_back({mesh, tuning::kMeshOrder});
    if (k.layer || !layer) c.parts.push_back({gap, 1});
  }
  return out;
}

}  // namespace mortise::study
