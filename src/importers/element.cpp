#include "importers/element.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "scene/suggest.h"

namespace mortise::importers {
namespace {

bool holds(const std::vector<std::string>& words, const std::string& word) { return std::find(words.begin(), words.end(), word) != words.end(); }

}  // namespace

std::string with_hint(const std::string& what, const std::string& typed, const std::vector<std::string>& known) {
  const std::string near = scene::nearest(typed, known);
  return what + (near.empty() ? "" : "; did you mean '" + near + "'?");
}

Source::Source(const std::string& text, std::string path, std::string language) : path_(std::move(path)), language_(std::move(language)), lines_{0} {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') lines_.push_back(static_cast<std::ptrdiff_t>(i) + 1);
}

Source::~Source() = default;

SourceLoc Source::at(std::ptrdiff_t offset) const {
  const auto line = std::upper_bound(lines_.begin(), lines_.end(), std::max<std::ptrdiff_t>(offset, 0)) - 1;
  return {path_, static_cast<int>(line - lines_.begin()) + 1, static_cast<int>(std::max<std::ptrdiff_t>(offset, 0) - *line) + 1};
}

Element Element::with(std::vector<Element> defaults) const {
  Element out = *this;
  out.defaults_ = std::move(defaults);
  return out;
}

const Element& Element::owner(const char* attribute) const {
  if (has_own(attribute)) return *this;
  for (const Element& e : defaults_)
    if (e.has_own(attribute)) return e;
  return *this;
}

std::string Element::text(const char* attribute) const {
  if (!has(attribute)) fail("<" + name() + "> has no attribute '" + attribute + "'");
  const Element& from = owner(attribute);
  const std::string value = from.node_.attribute(attribute).value();
  if (value.empty()) from.fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is empty");
  return value;
}

std::vector<double> Element::numbers(const char* attribute) const {
  const std::string value = text(attribute);
  std::vector<double> out;
  const char *at = value.data(), *end = at + value.size();
  while (true) {
    while (at != end && std::isspace(static_cast<unsigned char>(*at))) ++at;
    if (at == end) return out;
    if (*at == '+') ++at;
    double x = 0;
    const auto [next, code] = std::from_chars(at, end, x);
    if (code != std::errc{} || !std::isfinite(x) || (next != end && !std::isspace(static_cast<unsigned char>(*next))))
      owner(attribute).fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + value + "', which is not made of numbers");
    out.push_back(x);
    at = next;
  }
}

std::vector<double> Element::numbers(const char* attribute, std::size_t count) const {
  std::vector<double> out = numbers(attribute);
  if (out.size() != count)
    owner(attribute).fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + text(attribute) + "'; must be " +
                          std::to_string(count) + " numbers");
  return out;
}

double Element::number(const char* attribute, std::optional<double> fallback) const {
  if (fallback && !has(attribute)) return *fallback;
  const std::vector<double> n = numbers(attribute);
  if (n.size() != 1)
    owner(attribute).fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + text(attribute) + "'; must be one number");
  return n[0];
}

Vec3 Element::vector(const char* attribute, std::optional<Vec3> fallback) const {
  if (fallback && !has(attribute)) return *fallback;
  const std::vector<double> n = numbers(attribute);
  if (n.size() != 3)
    owner(attribute).fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + text(attribute) + "'; must be three numbers");
  return {n[0], n[1], n[2]};
}

std::vector<Element> Element::children(const char* name) const {
  std::vector<Element> out;
  for (const Element& e : children())
    if (e.name() == name) out.push_back(e);
  return out;
}

std::vector<Element> Element::children() const {
  std::vector<Element> out;
  for (const pugi::xml_node& n : node_.children()) {
    if (n.type() != pugi::node_element) continue;
    const Element e(n, *source_);
    const auto file = source_->included.find(e.offset());
    if (file == source_->included.end()) {
      out.push_back(e);
      continue;
    }
    for (Element& inside : file->second->root().children()) out.push_back(std::move(inside));
  }
  return out;
}

std::optional<Element> Element::child(const char* name) const {
  const std::vector<Element> all = children(name);
  if (all.size() > 1) all[1].fail("a second <" + std::string(name) + "> in <" + this->name() + ">");
  return all.empty() ? std::nullopt : std::optional(all[0]);
}

void Element::expect(const std::vector<std::string>& attributes, const std::vector<std::string>& elements, const std::vector<std::string>& dropped,
                     Notes& notes) const {
  for (const pugi::xml_attribute& a : node_.attributes()) {
    const std::string called = a.name(), what = "attribute '" + called + "' of <" + name() + ">";
    if (holds(attributes, called) || called.rfind("xmlns", 0) == 0) continue;
    notes.add(where(), holds(dropped, called) ? what + " is not imported"
                                              : with_hint(what + " is none of " + source_->language() + "'s, and not imported", called, attributes));
  }
  for (const Element& e : children()) {
    const std::string called = e.name(), what = "<" + called + "> in <" + name() + ">";
    if (holds(elements, called)) continue;
    notes.add(e.where(), holds(dropped, called) ? what + " is not imported"
                                                : with_hint(what + " is none of " + source_->language() + "'s, and not imported", called, elements));
  }
}

Document::Document(const std::string& text, const std::string& path, const std::string& language) : source(text, path, language) {
  const pugi::xml_parse_result result = xml.load_buffer(text.data(), text.size());
  if (!result) throw Error(Exit::scene, source.at(result.offset), std::string("not well-formed XML: ") + result.description());
}

}  // namespace mortise::importers
