#pragma once
#include <map>
#include <string>
#include <vector>

namespace mortise::exporters {

// Pictures in a folder that belong together, in order: "front" for front_0000.png, front_0006.png, ...; only 8-bit colour pictures of ours.
std::map<std::string, std::vector<std::string>> picture_series(const std::string& folder);

// Makes a film of them with ffmpeg, which has to be installed: .mp4 (H.264) or .gif, by the name of `path`. Throws Error(Exit::file).
void write_film(const std::string& path, const std::vector<std::string>& pictures, double fps);

}  // namespace mortise::exporters
