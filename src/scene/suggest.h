#pragma once
#include <string>
#include <vector>

namespace mortise::scene {

// Fewest insertions, deletions, replacements and swaps of neighbours that turn a into b.
int edit_distance(const std::string& a, const std::string& b);

// The candidate that `typed` was most likely meant to be (distance <= 2 or a third of its length), "" if none is near.
std::string nearest(const std::string& typed, const std::vector<std::string>& candidates);

// "did you mean 'b'? (also: a, c)"; without a near candidate the whole list when it is short, else "".
std::string suggestion(const std::string& typed, const std::vector<std::string>& candidates);

std::string join(const std::vector<std::string>& words, const std::string& separator);

}  // namespace mortise::scene
