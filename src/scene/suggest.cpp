#include "scene/suggest.h"

#include <algorithm>
#include <utility>

namespace mortise::scene {

constexpr std::size_t kListed = 8;  // longer lists are not printed

// d[i][j] = distance of the first i letters of a and the first j of b (optimal string alignment).
int edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<int>> d(a.size() + 1, std::vector<int>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = static_cast<int>(i + j);
        continue;
      }
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

// Words of other programs.
constexpr std::pair<const char*, const char*> kOtherWords[] = {
    {"gravitation", "gravity"},
    {"rigid", "stiff"},
    {"deformable", "soft"},
    {"elastic", "soft"},
    {"plane", "half_space"},
    {"ground", "half_space"},
    {"fixed", "pin"},
    {"contact", "barrier_contact"},
    {"loc", "position"},
    {"origin", "position"},
    {"translation", "position"},
    {"rpy", "rotation"},
    {"orientation", "rotation"},
    {"position", "point"},
    {"offset", "point"},
    {"parent", "to"},
    {"child", "body"},
    {"dt", "step"},
    {"timestep", "step"},
    {"time_step", "step"},
    {"coefficient", "mu"},
    {"friction_coefficient", "mu"},
    {"E", "youngs_modulus"},
    {"nu", "poisson_ratio"},
    {"rho", "density"},
};

std::string nearest(const std::string& typed, const std::vector<std::string>& candidates) {
  if (typed.size() > 100) return "";
  const int allowed = std::max(2, static_cast<int>(typed.size()) / 3);
  std::string best;
  int least = allowed + 1;
  for (const std::string& c : candidates) {
    const int d = edit_distance(typed, c);
    // Replacing every letter of a short word is no typing error.
    if (d < least && d < static_cast<int>(std::min(typed.size(), c.size()))) least = d, best = c;
  }
  if (!best.empty()) return best;
  for (const auto& [other, ours] : kOtherWords)
    if (typed == other && std::find(candidates.begin(), candidates.end(), ours) != candidates.end()) return ours;
  // "pos", "vel": the beginning of one alone.
  const auto begins = [&](const std::string& c) { return typed.size() >= 3 && c.starts_with(typed); };
  return std::count_if(candidates.begin(), candidates.end(), begins) == 1 ? *std::find_if(candidates.begin(), candidates.end(), begins) : "";
}

std::string suggestion(const std::string& typed, const std::vector<std::string>& candidates) {
  const std::string best = nearest(typed, candidates);
  std::vector<std::string> others;
  for (const std::string& c : candidates)
    if (c != best) others.push_back(c);
  if (best.empty()) return candidates.empty() || candidates.size() > kListed ? "" : "known here: " + join(candidates, ", ");
  std::string text = "did you mean '" + best + "'?";
  if (!others.empty() && candidates.size() <= kListed) text += " (also: " + join(others, ", ") + ")";
  return text;
}

std::string join(const std::vector<std::string>& words, const std::string& separator) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : separator) + w;
  return out;
}

}  // namespace mortise::scene
