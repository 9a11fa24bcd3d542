#include "cost/past.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.h"
#include "base/json_text.h"
#include "cost/tuning.h"
#include "geometry/cache_folder.h"
#include "output/atomic_file.h"
#include "output/hardware.h"

namespace mortise::cost {
namespace {

using Line = nlohmann::ordered_json;

std::string times_file() {
  const std::filesystem::path folder = geometry::cache_folder();
  return folder.empty() ? "" : (folder / "times.jsonl").string();
}

bool read_line(const std::string& text, Past& out) {
  const Line j = Line::parse(text, nullptr, false);
  if (!j.is_object()) return false;
  try {
    out.physics = j.at("physics"), out.kind = j.at("kind"), out.version = j.at("version"), out.cpu = j.at("cpu"), out.date = j.at("date");
    out.threads = j.at("threads"), out.steps = j.at("steps"), out.iterations = j.at("iterations");
    out.seconds = j.at("cpu_seconds"), out.model = j.at("model");
  } catch (const nlohmann::json::exception&) {
    return false;
  }
  return out.steps > 0 && out.iterations >= 0 && out.seconds > 0 && out.model > 0 && std::isfinite(out.seconds + out.model);
}

std::string read_all(const std::string& path) {
  try {
    return output::read_file(path);
  } catch (const Error&) {
    return "";
  }
}

}  // namespace

void keep(const Past& r) {
  const std::string path = times_file();
  if (path.empty()) return;
  std::error_code ec;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path(), ec);
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) return;
  const Line j{{"physics", r.physics},     {"kind", r.kind},       {"version", r.version}, {"cpu", r.cpu},
               {"date", r.date},           {"threads", r.threads}, {"steps", r.steps},     {"iterations", r.iterations},
               {"cpu_seconds", r.seconds}, {"model", r.model}};
  const std::string line = json_text(j) + "\n";
  if (flock(file, LOCK_EX) == 0) {
    if (std::filesystem::file_size(path, ec) > tuning::kMostKept && !ec) {
      const std::string all = read_all(path);
      const std::size_t half = all.find('\n', all.size() / 2);
      const std::string newer = half == std::string::npos ? "" : all.substr(half + 1);
      if (ftruncate(file, 0) == 0 && !newer.empty()) (void)!write(file, newer.data(), newer.size());
    }
    (void)!write(file, line.data(), line.size());
  }
  close(file);
}

std::vector<Past> kept_runs() {
  std::vector<Past> out;
  const std::string path = times_file();
  if (path.empty() || !std::filesystem::is_regular_file(path)) return out;
  const std::string cpu = output::hardware().cpu;
  std::istringstream lines(read_all(path));
  for (std::string text; std::getline(lines, text);)
    if (Past run; read_line(text, run) && run.cpu == cpu) out.push_back(run);
  return out;
}

}  // namespace mortise::cost
