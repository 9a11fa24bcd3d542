#include "bench/benchmark.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "bench/all.h"
#include "geometry/io/text.h"

namespace mortise::bench {

Bench::Bench(std::string scene, const std::vector<std::string>& sets, BenchOutput output) : scene_(std::move(scene)), output_(std::move(output)) {
  for (const std::string& s : sets) {
    const std::size_t eq = s.find('=');
    if (eq == std::string::npos || eq == 0) throw Error(Exit::usage, "--set " + s + ": write key=value");
    const std::string key = s.substr(0, eq), value = s.substr(eq + 1);
    if (key.find('.') == std::string::npos)
      options_.emplace_back(key, value);
    else
      scene_.set(key, value);
  }
}

std::string Bench::option(const std::string& key, const std::string& fallback) const {
  std::string value = fallback;
  for (const auto& [k, v] : options_)
    if (k == key) value = v;
  return value;
}

double Bench::number(const std::string& key, double fallback) const {
  const std::string text = option(key, "");
  if (text.empty()) return fallback;
  const std::optional<double> out = geometry::number_from<double>(text);
  if (!out || !(*out > 0) || std::isinf(*out)) throw Error(Exit::usage, "--set " + key + ": '" + text + "' is no number above 0");
  return *out;
}

int Bench::count(const std::string& key, int fallback) const {
  const std::string text = option(key, "");
  if (text.empty()) return fallback;
  const std::optional<int> out = geometry::number_from<int>(text);
  if (!out || *out <= 0) throw Error(Exit::usage, "--set " + key + ": '" + text + "' is no whole number above 0");
  return *out;
}

int Bench::order(int fallback) const {
  const std::string text = option("order", std::to_string(fallback));
  if (text != "1" && text != "2") throw Error(Exit::usage, "--set order: 1 or 2");
  return text == "1" ? 1 : 2;
}

void Bench::draw(const std::string& file, const std::function<void(const std::string&)>& write) const {
  if (output_.folder.empty()) return;
  const std::string path = output_.folder + "/" + file;
  const auto note = [&](const std::string& text) {
    if (output_.note) output_.note(text);
  };
  std::error_code ec;
  std::filesystem::create_directories(output_.folder, ec);
  if (ec) throw Error(Exit::file, "cannot create '" + output_.folder + "': " + ec.message());
  try {
    write(path);
    note("written: " + path);
  } catch (const Error& e) {
    if (e.code() != Exit::device) throw;
    note("not drawn: " + path + " (" + e.what() + ")");
  }
}

std::vector<Method> Bench::methods() const {
  const std::string wanted = option("methods", "");
  if (wanted.empty()) return bench::methods();
  std::vector<Method> out;
  std::string rest = wanted + ",";
  for (std::size_t comma; (comma = rest.find(',')) != std::string::npos; rest.erase(0, comma + 1)) {
    const std::string name = rest.substr(0, comma);
    const auto& all = bench::methods();
    const auto it = std::find_if(all.begin(), all.end(), [&](const Method& m) { return m.name == name; });
    if (it == all.end()) {
      std::string known;
      for (const Method& m : all) known += (known.empty() ? "" : ", ") + m.name;
      throw Error(Exit::usage, "--set methods: no method '" + name + "'; there are " + known);
    }
    out.push_back(*it);
  }
  return out;
}

const Benchmark* find_benchmark(const std::string& name) {
  for (const Benchmark& b : benchmarks())
    if (name == b.name) return &b;
  return nullptr;
}

std::span<const Benchmark> benchmarks() {
  static const Benchmark all[] = {
      {"barrier", "gap of a block on a plane under uniform pressure (B27)", {}, barrier},
      {"patch", "uniform stress through two blocks with matching and other meshes (B01, B02, B05)", {"order", "case", "finer"}, bench::patch},
      {"hertz",
       "sphere on a block: pressure, its peak, contact radius (B07)",
       {"size", "under", "order", "d_hat", "layer", "k", "start", "mesh"},
       bench::hertz},
      {"spheres", "sphere on a sphere: pressure, its peak, contact radius (B06)", {"cells", "layer"}, bench::spheres},
      {"pin", "pin in a bore: pressure, angle of contact (B14, without friction)", {"cells", "order", "k", "layer"}, bench::pin},
      {"interface", "hydrostatic pressure through an inclined plane (B03) and a wavy surface (B04)", {"finest"}, bench::interface},
      {"line", "cylinder on a block in plane strain: pressure, half-width (B08)", {"size", "layer"}, bench::line},
      {"indent", "rigid flat and conical punches on a half-space (B11, B12)", {"cells", "order"}, bench::indent},
      {"locking", "cantilever, Cook's membrane and bonded pad near Poisson's ratio 0.5", {"case", "finer"}, locking},
      {"ring", "ring pressed onto a ring: mean pressure (B23)", {"cells"}, bench::ring},
      {"partition", "overlaps of two meshes fill a face, however close the meshes come to each other (H59, H60)", {"ratio"}, bench::partition},
      {"sharp", "sharp edge and corner pressed into a pad: true gap, steps that converge", {}, bench::sharp},
      {"tower", "forces and gaps in a stack of blocks under gravity (B26)", {}, bench::tower},
      {"slide", "drag of a block on a tessellated plane without friction (H58)", {}, bench::slide},
  };
  return all;
}

std::vector<Row> run_benchmark(const Benchmark& benchmark, const std::vector<std::string>& sets, const BenchOutput& output) {
  for (const std::string& s : sets) {
    const std::string key = s.substr(0, s.find('='));
    if (key.find('.') != std::string::npos || key == "methods") continue;
    if (std::find(benchmark.options.begin(), benchmark.options.end(), key) != benchmark.options.end()) continue;
    std::string known = "methods";
    for (const std::string& o : benchmark.options) known += ", " + o;
    throw Error(Exit::usage, "benchmark '" + std::string(benchmark.name) + "' has no option '" + key + "'; it has " + known +
                                 " and the values of its scene (a.b=c)");
  }
  std::vector<Row> rows;
  BenchOutput collected = output;
  collected.row = [&](const Row& row) {
    rows.push_back(row);
    if (output.row) output.row(row);
  };
  benchmark.run(Bench(benchmark_scene(benchmark.name), sets, collected));
  if (rows.empty()) throw Error(Exit::usage, "benchmark '" + std::string(benchmark.name) + "' has no such case");
  return rows;
}

}  // namespace mortise::bench
