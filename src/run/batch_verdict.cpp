#include "run/batch_verdict.h"

#include <fmt/format.h>

#include <algorithm>

namespace mortise::run {

BatchVerdict verdict_of(const std::vector<EnvironmentEnd>& ends, const std::string& table) {
  const auto count = static_cast<long>(ends.size());
  const auto how_many = [&](auto is) { return std::count_if(ends.begin(), ends.end(), is); };
  const long refused = how_many([](const EnvironmentEnd& e) { return e.code == static_cast<int>(Exit::checks); });
  BatchVerdict out;
  out.failed = how_many([](const EnvironmentEnd& e) { return e.failed(); });
  out.unfinished = how_many([](const EnvironmentEnd& e) { return e.code < 0 || e.stopped(); });
  if (out.unfinished > 0) {
    out.code = Exit::stopped;
  } else if (out.failed > 0) {
    out.code = Exit::solve;
    std::string which;
    long named = 0;
    for (long e = 0; e < count; ++e) {
      if (!ends[e].failed()) continue;
      // A bad scene and a failed step are an environment's own; what is left hangs on the machine.
      if (ends[e].code != static_cast<int>(Exit::solve) && ends[e].code != static_cast<int>(Exit::scene) && out.code == Exit::solve)
        out.code = static_cast<Exit>(ends[e].code);
      constexpr long kNamed = 10;
      if (named++ < kNamed) which += (which.empty() ? "" : ", ") + std::to_string(e);
      if (named == kNamed + 1) which += ", ...";
    }
    out.message = fmt::format("{} of {} environments failed ({}); {} says why, and all others are complete", out.failed, count, which, table);
    if (out.failed == count) out.message = fmt::format("all {} environments failed; the first: {}", count, ends[0].message);
  } else if (refused > 0) {
    out.code = Exit::checks, out.message = fmt::format("checks failed in {} of {} environments", refused, count);
  }
  return out;
}

}  // namespace mortise::run
