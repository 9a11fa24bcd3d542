#pragma once
// An XML element with its place in the file. What is asked for is remembered, so that the rest can be named.
#include <map>
#include <memory>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/types.h"
#include "importers/notes.h"

namespace mortise::importers {

struct Document;

// Where lines begin, so that pugixml's offsets become lines and columns.
class Source {
 public:
  Source(const std::string& text, std::string path, std::string language);
  ~Source();
  SourceLoc at(std::ptrdiff_t offset) const;
  const std::string& path() const { return path_; }
  const std::string& language() const { return language_; }  // what messages call the format

  // Files whose contents stand in the place of an element, by its offset.
  std::map<std::ptrdiff_t, std::unique_ptr<Document>> included;

 private:
  std::string path_, language_;
  std::vector<std::ptrdiff_t> lines_;  // offsets of their first characters
};

// `what`, and which of the known words was meant, if one is near to what was typed.
std::string with_hint(const std::string& what, const std::string& typed, const std::vector<std::string>& known);

class Element {
 public:
  Element(pugi::xml_node node, const Source& source) : node_(node), source_(&source) {}
  // The same with attributes from elsewhere where it has none of its own; the first of `defaults` that has one counts.
  Element with(std::vector<Element> defaults) const;

  std::string name() const { return node_.name(); }
  std::ptrdiff_t offset() const { return node_.offset_debug() - 1; }  // of its <
  SourceLoc where() const { return source_->at(offset()); }
  const Source& source() const { return *source_; }
  [[noreturn]] void fail(const std::string& what) const { throw Error(Exit::scene, where(), what); }

  bool has(const char* attribute) const { return !owner(attribute).node_.attribute(attribute).empty(); }
  bool has_own(const char* attribute) const { return !node_.attribute(attribute).empty(); }
  std::string text(const char* attribute) const;  // must be there
  std::string text(const char* attribute, const std::string& fallback) const { return has(attribute) ? text(attribute) : fallback; }
  double number(const char* attribute, std::optional<double> fallback = {}) const;  // without fallback: must be there
  Vec3 vector(const char* attribute, std::optional<Vec3> fallback = {}) const;      // three numbers
  std::vector<double> numbers(const char* attribute) const;
  std::vector<double> numbers(const char* attribute, std::size_t count) const;  // as many as that

  std::optional<Element> child(const char* name) const;  // the first; a second one is an error
  std::vector<Element> children(const char* name) const;
  std::vector<Element> children() const;  // all, in their order

  // Notes attributes and elements other than these: those in `dropped` as not imported, the rest as unknown.
  void expect(const std::vector<std::string>& attributes, const std::vector<std::string>& elements, const std::vector<std::string>& dropped,
              Notes& notes) const;

 private:
  const Element& owner(const char* attribute) const;  // that has it; itself where none does

  pugi::xml_node node_;
  const Source* source_;
  std::vector<Element> defaults_;
};

// A file of XML. Throws Error(Exit::scene) with its place where it is none.
struct Document {
  Document(const std::string& text, const std::string& path, const std::string& language);
  Element root() const { return Element(xml.document_element(), source); }
  Source source;
  pugi::xml_document xml;
};

}  // namespace mortise::importers
