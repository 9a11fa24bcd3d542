#pragma once
// An XML element with its place in the file. What is asked for is remembered, so that the rest can be named.
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/types.h"
#include "importers/notes.h"

namespace mortise::importers::urdf {

// Where lines begin, so that pugixml's offsets become lines and columns.
class Source {
 public:
  Source(const std::string& text, std::string path);
  SourceLoc at(std::ptrdiff_t offset) const;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<std::ptrdiff_t> lines_;  // offsets of their first characters
};

// `what`, and which of the known words was meant, if one is near to what was typed.
std::string with_hint(const std::string& what, const std::string& typed, const std::vector<std::string>& known);

class Element {
 public:
  Element(pugi::xml_node node, const Source& source) : node_(node), source_(&source) {}

  std::string name() const { return node_.name(); }
  SourceLoc where() const { return source_->at(node_.offset_debug() - 1); }  // of its <
  [[noreturn]] void fail(const std::string& what) const { throw Error(Exit::scene, where(), what); }

  bool has(const char* attribute) const { return !node_.attribute(attribute).empty(); }
  std::string text(const char* attribute) const;                                    // must be there
  double number(const char* attribute, std::optional<double> fallback = {}) const;  // without fallback: must be there
  Vec3 vector(const char* attribute, std::optional<Vec3> fallback = {}) const;      // three numbers
  std::vector<double> numbers(const char* attribute) const;

  std::optional<Element> child(const char* name) const;  // the first; a second one is an error
  std::vector<Element> children(const char* name) const;

  // Notes attributes and elements other than these: those in `dropped` as not imported, the rest as unknown.
  void expect(const std::vector<std::string>& attributes, const std::vector<std::string>& elements, const std::vector<std::string>& dropped,
              Notes& notes) const;

 private:
  pugi::xml_node node_;
  const Source* source_;
};

}  // namespace mortise::importers::urdf
