#include "scene/environments.h"

#include "base/philox.h"
#include "scene/distribution.h"
#include "scene/draw.h"
#include "scene/vary_place.h"

namespace mortise::scene {
namespace {

Distribution distribution_of(const Params& written) {
  static const std::map<std::string, Distribution::Kind> kinds{{"uniform", Distribution::Kind::uniform},
                                                               {"log_uniform", Distribution::Kind::log_uniform},
                                                               {"normal", Distribution::Kind::normal},
                                                               {"choice", Distribution::Kind::choice}};
  const auto& [name, numbers] = written.entries().front();
  Distribution out;
  out.kind = kinds.at(name);
  if (out.kind != Distribution::Kind::choice) out.a = numbers.items()[0].as_number(), out.b = numbers.items()[1].as_number();
  return out;
}

// The number at a path that was checked; null where the scene leaves it to be chosen.
const Params* at_path(const Params& root, const std::string& path) {
  const Params* here = &root;
  for (const std::string& part : split_path(path)) {
    here = here->kind() == Params::Kind::list ? &here->items().at(std::stoul(part)) : here->find(part);
    if (!here) return nullptr;
  }
  return here;
}

}  // namespace

const Params* way_of(const Params& entry, std::string& name) {
  const Params* found = nullptr;
  for (const char* way : kWays)
    if (const Params* d = entry.find(way)) {
      if (found) return nullptr;
      found = d, name = way;
    }
  return found;
}

double combined(const std::string& way, double base, double drawn) { return way == "scale" ? base * drawn : way == "add" ? base + drawn : drawn; }

double drawn_from(const Params& written, double u) {
  const Distribution d = distribution_of(written);
  if (d.kind != Distribution::Kind::choice) return d.number(u);
  const std::vector<double> values = written.entries().front().second.as_numbers();
  return values[Distribution::one_of(u, values.size())];
}

// One draw: its index has room for 2^32 environments and as many episodes.
double chance(const Params& block, const std::string& path, long environment, long episode) {
  const Stream stream(static_cast<std::uint64_t>(block.integer("seed")), path);
  return stream.at(static_cast<std::uint64_t>(environment) | static_cast<std::uint64_t>(episode) << 32)[0];
}

long environment_count(const Params& root) {
  const Params* block = root.find("environments");
  return block ? static_cast<long>(block->integer("count")) : 0;
}

std::vector<Drawn> draw(const Params& root, long environment, long episode) {
  std::vector<Drawn> out;
  const Params& block = root.at("environments");
  const Params* vary = block.find("vary");
  for (std::size_t i = 0; vary && i < vary->items().size(); ++i) {
    const Params& entry = vary->items()[i];
    const std::string& path = entry.text("path");
    std::string way;
    const Params& how = *way_of(entry, way);
    const Params* base = at_path(root, path);
    const double drawn = drawn_from(how, chance(block, path, environment, episode));
    out.push_back({path, drawn, combined(way, base ? base->as_number() : 0, drawn)});
  }
  return out;
}

}  // namespace mortise::scene
