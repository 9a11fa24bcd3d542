#include "exporters/film.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "base/process.h"
#include "output/atomic_file.h"
#include "render/image.h"

namespace fs = std::filesystem;

namespace mortise::exporters {
namespace {

constexpr std::size_t kLogShown = 600;  // characters of what ffmpeg said last

std::string on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folders = path != nullptr ? path : "";
  for (std::size_t at = 0; at <= folders.size();) {
    const std::size_t end = std::min(folders.find(':', at), folders.size());
    const std::string candidate = folders.substr(at, end - at) + "/" + program;
    std::error_code ignored;
    if (end > at && fs::is_regular_file(candidate, ignored) && access(candidate.c_str(), X_OK) == 0) return candidate;
    at = end + 1;
  }
  return "";
}

// A line of a list of ffmpeg's: within quotes, a quote is '\''.
std::string quoted(const std::string& path) {
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace

std::map<std::string, std::vector<std::string>> picture_series(const std::string& folder) {
  std::map<std::string, std::vector<std::pair<long, std::string>>> found;
  std::error_code ec;
  for (fs::directory_iterator it(folder, ec), end; !ec && it != end; it.increment(ec)) {
    const std::string path = it->path().string(), stem = it->path().stem().string();
    const std::size_t at = stem.rfind('_');
    if (it->path().extension() != ".png" || at == std::string::npos || stem.size() - at < 5 || stem.size() - at > 18) continue;
    if (stem.find_first_not_of("0123456789", at + 1) != std::string::npos) continue;
    if (render::is_our_png(path) && render::is_color_png(path)) found[stem.substr(0, at)].emplace_back(std::stol(stem.substr(at + 1)), path);
  }
  std::map<std::string, std::vector<std::string>> out;
  for (auto& [name, pictures] : found) {
    std::sort(pictures.begin(), pictures.end());
    for (const auto& [frame, path] : pictures) out[name].push_back(path);
  }
  return out;
}

void write_film(const std::string& path, const std::vector<std::string>& pictures, double fps) {
  const std::string ffmpeg = on_path("ffmpeg");
  if (ffmpeg.empty())
    throw Error(Exit::file, "films are made by ffmpeg, which is not installed (Debian: apt install ffmpeg)\n  the pictures are in " +
                                fs::path(pictures.front()).parent_path().string());
  const bool gif = fs::path(path).extension() == ".gif";
  const std::string list = path + ".list", log = path + ".log", part = path + ".part" + (gif ? ".gif" : ".mp4");
  // Each picture for one over the rate; the last one once more, because the list's reader passes over the last duration.
  std::string text = "ffconcat version 1.0\n";
  for (const std::string& p : pictures) text += fmt::format("file {}\nduration {:.9g}\n", quoted(fs::absolute(p).string()), 1 / fps);
  text += fmt::format("file {}\n", quoted(fs::absolute(pictures.back()).string()));
  output::write_file_atomically(list, text, false);
  const std::string rate = fmt::format("{:.9g}", fps);
  std::vector<std::string> command = {ffmpeg, "-nostdin", "-y", "-loglevel", "error", "-f", "concat", "-safe", "0", "-i", list, "-r", rate};
  const std::vector<std::string> how =
      gif ? std::vector<std::string>{"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse"}
          : std::vector<std::string>{"-c:v", "libx264", "-pix_fmt", "yuv420p", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-movflags", "+faststart"};
  command.insert(command.end(), how.begin(), how.end());
  command.insert(command.end(), {"-frames:v", std::to_string(pictures.size()), fs::absolute(part).string()});
  int status = 0;
  waitpid(start_program(command, log, log), &status, 0);
  std::string said;
  std::error_code ignored;
  if (fs::exists(log, ignored)) said = output::read_file(log);
  for (const std::string& temporary : {list, log}) fs::remove(temporary, ignored);
  if (code_of(status) != 0) {
    fs::remove(part, ignored);
    if (said.size() > kLogShown) said = "..." + said.substr(said.size() - kLogShown);
    throw Error(Exit::file, fmt::format("ffmpeg could not make '{}' (exit code {})\n{}", path, code_of(status), said));
  }
  output::rename_file(part, path);
}

}  // namespace mortise::exporters
