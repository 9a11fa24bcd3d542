#pragma once
#include <string>
#include <string_view>

namespace mortise::output {

// Replaces the file `path` by `bytes` so that a reader sees the old or the new content, never a mixture: written beside it
// as `path`.tmp, then renamed. With `durable` file and folder are also fsynced, so the content survives a power cut.
// Throws Error(Exit::file) with the path and the reason; the old file is then untouched and no temporary is left.
void write_file_atomically(const std::string& path, std::string_view bytes, bool durable);

// The two halves of it, for callers that rename more than one file. write_file removes what it wrote when it fails.
void write_file(const std::string& path, std::string_view bytes, bool durable);
void rename_file(const std::string& from, const std::string& to);
// `to` becomes another name of `from`, at once; where a file system has no second names, `from` is renamed to it.
void keep_file_as(const std::string& from, const std::string& to);
void sync_folder_of(const std::string& path);

// Whole content of a file. Throws Error(Exit::file).
std::string read_file(const std::string& path);

}  // namespace mortise::output
