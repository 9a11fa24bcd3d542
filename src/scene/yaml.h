#pragma once
// The scene file as written: every key and value with its place, duplicates included. yaml-cpp's own tree forgets the place of
// keys and drops one of two equal keys without a word, so only its event parser is used.
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace mortise::scene {

struct Node {
  enum class Kind { null, scalar, list, map };
  Kind kind = Kind::null;
  std::string text;                                   // scalar
  bool quoted = false;                                // scalar in quotes (or a block scalar): text, never a number
  SourceLoc at;                                       // the value
  SourceLoc key_at;                                   // its key, or the value itself in a list
  std::vector<Node> items;                            // list
  std::vector<std::pair<std::string, Node>> entries;  // map, in file order

  // Defaulted below, where Node is complete: its entries hold Nodes.
  Node();
  Node(const Node&);
  Node(Node&&) noexcept;
  Node& operator=(const Node&);
  Node& operator=(Node&&) noexcept;
  ~Node();

  const Node* find(const std::string& key) const;
  Node* find(const std::string& key);
  // "a list", "'abc'": how a message calls what stands here.
  std::string describe() const;
};

inline Node::Node() = default;
inline Node::Node(const Node&) = default;
inline Node::Node(Node&&) noexcept = default;
inline Node& Node::operator=(const Node&) = default;
inline Node& Node::operator=(Node&&) noexcept = default;
inline Node::~Node() = default;

struct SyntaxError {
  SourceLoc at;
  std::string message;
};

// Throws SyntaxError for malformed YAML. `file` goes into every place. With fixed != nullptr all places
// are *fixed (values of overrides and of defaults).
Node parse_yaml(const std::string& text, const std::string& file, const SourceLoc* fixed = nullptr);

}  // namespace mortise::scene
