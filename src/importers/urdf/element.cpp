#include "importers/urdf/element.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "scene/suggest.h"

namespace mortise::importers::urdf {
namespace {

bool holds(const std::vector<std::string>& words, const std::string& word) { return std::find(words.begin(), words.end(), word) != words.end(); }

}  // namespace

std::string with_hint(const std::string& what, const std::string& typed, const std::vector<std::string>& known) {
  const std::string near = scene::nearest(typed, known);
  return what + (near.empty() ? "" : "; did you mean '" + near + "'?");
}

Source::Source(const std::string& text, std::string path) : path_(std::move(path)), lines_{0} {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') lines_.push_back(static_cast<std::ptrdiff_t>(i) + 1);
}

SourceLoc Source::at(std::ptrdiff_t offset) const {
  const auto line = std::upper_bound(lines_.begin(), lines_.end(), std::max<std::ptrdiff_t>(offset, 0)) - 1;
  return {path_, static_cast<int>(line - lines_.begin()) + 1, static_cast<int>(std::max<std::ptrdiff_t>(offset, 0) - *line) + 1};
}

std::string Element::text(const char* attribute) const {
  if (!has(attribute)) fail("<" + name() + "> has no attribute '" + attribute + "'");
  const std::string value = node_.attribute(attribute).value();
  if (value.empty()) fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is empty");
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
      fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + value + "', which is not made of numbers");
    out.push_back(x);
    at = next;
  }
}

double Element::number(const char* attribute, std::optional<double> fallback) const {
  if (fallback && !has(attribute)) return *fallback;
  const std::vector<double> n = numbers(attribute);
  if (n.size() != 1) fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + text(attribute) + "'; must be one number");
  return n[0];
}

Vec3 Element::vector(const char* attribute, std::optional<Vec3> fallback) const {
  if (fallback && !has(attribute)) return *fallback;
  const std::vector<double> n = numbers(attribute);
  if (n.size() != 3) fail("attribute '" + std::string(attribute) + "' of <" + name() + "> is '" + text(attribute) + "'; must be three numbers");
  return {n[0], n[1], n[2]};
}

std::vector<Element> Element::children(const char* name) const {
  std::vector<Element> out;
  for (const pugi::xml_node& n : node_.children(name)) out.emplace_back(n, *source_);
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
    notes.add(where(),
              holds(dropped, called) ? what + " is not imported" : with_hint(what + " is none of URDF's, and not imported", called, attributes));
  }
  for (const pugi::xml_node& n : node_.children()) {
    if (n.type() != pugi::node_element || holds(elements, n.name())) continue;
    const std::string called = n.name(), what = "<" + called + "> in <" + name() + ">";
    notes.add(Element(n, *source_).where(),
              holds(dropped, called) ? what + " is not imported" : with_hint(what + " is none of URDF's, and not imported", called, elements));
  }
}

}  // namespace mortise::importers::urdf
