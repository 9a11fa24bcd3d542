#include "scene/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include <map>
#include <sstream>

#include "base/read_file.h"

namespace mortise::scene {
namespace {

constexpr int kMostNodes = 1000000;  // aliases of aliases can grow without bound

class Builder : public YAML::EventHandler {
 public:
  Builder(std::string file, const SourceLoc* fixed) : file_(std::move(file)), fixed_(fixed) {}

  Node root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { put(make(Node::Kind::null, mark), anchor); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto it = anchors_.find(anchor);
    // An anchor inside the value that it names is still open and not in the table.
    if (it == anchors_.end()) throw SyntaxError{place(mark), "this alias stands inside the value it refers to"};
    Node copy = it->second;
    count(copy, mark);
    put(std::move(copy), 0);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
    // Tag "!" marks a quoted scalar, "?" a plain one.
    Node n = make(Node::Kind::scalar, mark);
    n.text = value;
    weigh(n, mark);
    n.quoted = tag == "!";
    no_tag(tag, mark);
    put(std::move(n), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    no_tag(tag, mark);
    open(make(Node::Kind::list, mark), anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    no_tag(tag, mark);
    open(make(Node::Kind::map, mark), anchor);
  }
  void OnMapEnd() override { close(); }

  SourceLoc place(const YAML::Mark& mark) const {  // marks count from 0
    return fixed_ ? *fixed_ : SourceLoc{file_, mark.line + 1, mark.column + 1};
  }

 private:
  struct Open {
    Node node;
    YAML::anchor_t anchor;
    bool has_key = false;
    std::string key;
    SourceLoc key_at;
  };

  Node make(Node::Kind kind, const YAML::Mark& mark) {
    Node n;
    n.kind = kind;
    n.at = n.key_at = place(mark);
    count(n, mark);
    return n;
  }
  void count(const Node& n, const YAML::Mark& mark) {
    if (++nodes_ > kMostNodes) throw SyntaxError{place(mark), "the scene has more than a million values"};
    weigh(n, mark);
    for (const Node& item : n.items) count(item, mark);
    for (const auto& [key, value] : n.entries) count(value, mark);
  }
  void weigh(const Node& n, const YAML::Mark& mark) {
    if (bytes_ += n.text.size(); bytes_ > max_bytes::scene) throw SyntaxError{place(mark), "the values of the scene are longer than 64 MiB in all"};
  }
  void no_tag(const std::string& tag, const YAML::Mark& mark) const {
    if (tag != "!" && tag != "?" && !tag.empty()) throw SyntaxError{place(mark), "YAML tags ('" + tag + "') are not used in scenes"};
  }
  void open(Node n, YAML::anchor_t anchor) {
    if (!stack_.empty() && stack_.back().node.kind == Node::Kind::map && !stack_.back().has_key)
      throw SyntaxError{n.at, "a key must be one word, not a list or a block"};
    stack_.push_back({std::move(n), anchor, false, "", {}});
  }
  void close() {
    Open done = std::move(stack_.back());
    stack_.pop_back();
    if (done.node.kind == Node::Kind::map) merge(done.node);
    put(std::move(done.node), done.anchor);
  }
  // The key `<<` stands for the keys of the block behind it, or of a list of blocks, as far as they are not written out (yaml.org/type/merge).
  void merge(Node& map) {
    std::vector<Node> from;
    for (auto entry = map.entries.begin(); entry != map.entries.end();) {
      if (entry->first != "<<") {
        ++entry;
        continue;
      }
      Node value = std::move(entry->second);
      entry = map.entries.erase(entry);
      if (value.kind == Node::Kind::map) value.items = {value};
      if (value.items.empty()) throw SyntaxError{value.at, "the merge key '<<' takes a block of keys, as in '<<: *anchor'"};
      for (Node& item : value.items) {
        if (item.kind != Node::Kind::map) throw SyntaxError{item.at, "the merge key '<<' takes blocks of keys"};
        from.push_back(std::move(item));
      }
    }
    for (const Node& block : from)
      for (const auto& [key, node] : block.entries)
        if (!map.find(key)) map.entries.emplace_back(key, node);
  }
  void put(Node n, YAML::anchor_t anchor) {
    if (anchor) anchors_[anchor] = n;
    if (stack_.empty()) {
      root = std::move(n);
      return;
    }
    Open& top = stack_.back();
    if (top.node.kind == Node::Kind::list) {
      top.node.items.push_back(std::move(n));
    } else if (!top.has_key) {
      if (n.kind != Node::Kind::scalar) throw SyntaxError{n.at, "a key must be one word"};
      top.has_key = true, top.key = std::move(n.text), top.key_at = n.at;
    } else {
      n.key_at = top.key_at;
      top.node.entries.emplace_back(std::move(top.key), std::move(n));
      top.has_key = false;
    }
  }

  std::string file_;
  const SourceLoc* fixed_;
  std::vector<Open> stack_;
  std::map<YAML::anchor_t, Node> anchors_;
  int nodes_ = 0;
  std::size_t bytes_ = 0;  // of all texts, aliases counted as often as they are used
};

}  // namespace

const Node* Node::find(const std::string& key) const {
  for (const auto& [k, v] : entries)
    if (k == key) return &v;
  return nullptr;
}
Node* Node::find(const std::string& key) { return const_cast<Node*>(static_cast<const Node*>(this)->find(key)); }

std::string Node::describe() const {
  switch (kind) {
    case Kind::null:
      return "empty";
    case Kind::scalar: {
      constexpr std::size_t kShown = 60;  // characters: the whole file may have been taken for one text
      const std::string seen = text.size() <= kShown + 3 ? text : text.substr(0, kShown) + "...";
      return quoted ? "the text \"" + seen + "\"" : "'" + seen + "'";
    }
    case Kind::list:
      return "a list";
    case Kind::map:
      return "a block of keys";
  }
  return "";
}

Node parse_yaml(const std::string& text, const std::string& file, const SourceLoc* fixed) {
  Builder builder(file, fixed);
  try {
    std::istringstream in(text);
    YAML::Parser parser(in);
    if (!parser.HandleNextDocument(builder)) return builder.root;
    Builder second(file, fixed);
    if (parser.HandleNextDocument(second)) throw SyntaxError{second.root.at, "a second YAML document starts here; a scene is one document"};
  } catch (const YAML::Exception& e) {
    throw SyntaxError{e.mark.is_null() ? SourceLoc{file, 0, 0} : builder.place(e.mark), "not valid YAML: " + e.msg};
  }
  return builder.root;
}

}  // namespace mortise::scene
