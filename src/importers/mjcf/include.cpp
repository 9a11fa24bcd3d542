#include "importers/mjcf/include.h"

#include <filesystem>
#include <set>

#include "base/read_file.h"

namespace mortise::importers::mjcf {
namespace {

namespace fs = std::filesystem;

void expand(const Element& e, Source& source, const fs::path& folder, std::set<std::string>& seen) {
  for (const Element& child : e.children()) {
    if (child.name() != "include") {
      expand(child, source, folder, seen);
      continue;
    }
    const std::string path = (folder / child.text("file")).lexically_normal().string();
    if (!seen.insert(path).second) child.fail("'" + path + "' is included twice");
    std::string text;
    try {
      text = read_regular_file(path, max_bytes::scene);
    } catch (const Error& error) {
      throw Error(error.code(), child.where(), error.what());
    }
    auto document = std::make_unique<Document>(text, path, source.language());
    expand(document->root(), document->source, folder, seen);
    source.included[child.offset()] = std::move(document);
  }
}

}  // namespace

void expand_includes(Document& document) {
  const fs::path path = fs::absolute(document.source.path()).lexically_normal();
  std::set<std::string> seen{path.string()};
  expand(document.root(), document.source, path.parent_path(), seen);
}

}  // namespace mortise::importers::mjcf
