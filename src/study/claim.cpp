#include "study/claim.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json_text.h"
#include "output/atomic_file.h"
#include "study/plan.h"

namespace fs = std::filesystem;

namespace mortise::study {
namespace {

using Claim = nlohmann::ordered_json;

Claim claim_of(const Study& s) {
  std::error_code ec;
  const fs::path scene = s.scene.empty() ? fs::path() : fs::weakly_canonical(s.scene, ec);
  Claim steps = Claim::array(), methods = Claim::array();
  for (const Ladder& ladder : s.ladders)
    for (const Ladder::Step& step : ladder.steps) steps.push_back(label_of(step.settings));
  for (const Method& m : s.methods) methods.push_back(m.name);
  return {{"scene", ec ? s.scene : scene.string()}, {"benchmark", s.benchmark}, {"set", s.set}, {"methods", methods}, {"steps", steps}};
}

// Does `now` lose nothing of what was studied before?
bool goes_on(const Claim& before, const Claim& now) {
  for (const char* key : {"scene", "benchmark", "set"})
    if (before.value(key, Claim()) != now[key]) return false;
  for (const char* key : {"methods", "steps"})
    for (const Claim& one : before.value(key, Claim::array()))
      if (std::find(now[key].begin(), now[key].end(), one) == now[key].end()) return false;
  return true;
}

std::string path_in(const std::string& folder) { return folder + "/studied.json"; }

Claim read_claims(const std::string& folder) {
  std::error_code ec;
  if (!fs::exists(path_in(folder), ec)) return Claim::object();
  const Claim all = Claim::parse(output::read_file(path_in(folder)), nullptr, false);
  return all.is_object() ? all : Claim::object();
}

}  // namespace

void refuse_another_study(const Study& study, const std::string& kind, const std::string& folder) {
  const Claim all = read_claims(folder);
  if (all.contains(kind) && !goes_on(all[kind], claim_of(study)))
    throw Error(Exit::usage, "'" + folder + "' holds another study (of another scene, other --set values or other ladders: " + path_in(folder) +
                                 "); use another -o, or --overwrite");
}

void note_study(const Study& study, const std::string& kind, const std::string& folder) {
  Claim all = read_claims(folder);
  all[kind] = claim_of(study);
  output::write_file_atomically(path_in(folder), json_text(all, 1) + "\n", false);
}

}  // namespace mortise::study
