#pragma once
// Classes of defaults: attributes that elements have which do not say them themselves. A class inside of another has what that has, and more.
#include <map>

#include "importers/element.h"

namespace mortise::importers::mjcf {

class Defaults {
 public:
  Defaults() { classes_["main"]; }
  void read(const Element& e);  // an outermost <default>
  // The element with what its class gives it, or that of the body around it where it names none. `tags`: whose defaults hold for it, those of the
  // first before those of the next; without any its own name.
  Element complete(const Element& e, const std::string& around, std::vector<std::string> tags = {}) const;
  bool knows(const std::string& name) const { return classes_.count(name) > 0; }
  std::vector<std::string> names() const;
  // All that stands in classes, for a look at words that nobody knows.
  const std::vector<Element>& written() const { return written_; }

 private:
  using Class = std::map<std::string, std::vector<Element>>;  // by tag, the nearest first
  void read(const Element& e, const std::string& name, const Class& parent);
  std::map<std::string, Class> classes_;
  std::vector<Element> written_;
};

}  // namespace mortise::importers::mjcf
