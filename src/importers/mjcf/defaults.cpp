#include "importers/mjcf/defaults.h"

namespace mortise::importers::mjcf {

void Defaults::read(const Element& e) {
  const std::string name = e.text("class", "main");
  read(e, name, name == "main" ? Class{} : classes_["main"]);
}

void Defaults::read(const Element& e, const std::string& name, const Class& parent) {
  Class& mine = classes_[name];
  for (const auto& [tag, elements] : parent) mine[tag].insert(mine[tag].end(), elements.begin(), elements.end());
  for (const Element& child : e.children())
    if (child.name() != "default") mine[child.name()].insert(mine[child.name()].begin(), child), written_.push_back(child);
  const Class so_far = mine;
  for (const Element& child : e.children("default")) {
    if (!child.has("class")) child.fail("a <default> inside of another needs a 'class'");
    const std::string called = child.text("class");
    if (knows(called)) child.fail("a second class of defaults '" + called + "'");
    read(child, called, so_far);
  }
}

Element Defaults::complete(const Element& e, const std::string& around, std::vector<std::string> tags) const {
  const std::string name = e.has_own("class") ? e.text("class") : around;
  const auto it = classes_.find(name);
  if (it == classes_.end()) e.fail(with_hint("there is no class of defaults '" + name + "'", name, names()));
  if (tags.empty()) tags.push_back(e.name());
  std::vector<Element> out;
  for (const std::string& tag : tags)
    if (const auto found = it->second.find(tag); found != it->second.end()) out.insert(out.end(), found->second.begin(), found->second.end());
  return e.with(std::move(out));
}

std::vector<std::string> Defaults::names() const {
  std::vector<std::string> out;
  for (const auto& [name, unused] : classes_) out.push_back(name);
  return out;
}

}  // namespace mortise::importers::mjcf
