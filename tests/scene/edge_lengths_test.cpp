#include "scene/edge_lengths.h"

#include <gtest/gtest.h>

namespace mortise::scene {
namespace {

Params table(const std::string& key, Params value) {
  Params out = Params::make_table();
  out.set(key, std::move(value));
  return out;
}

TEST(EdgeLengths, AreFoundInShapesAndTheirParts) {
  Params mesh = table("edge_length", Params::make_number(0.2));
  mesh.set("surface_edge_length", Params::make_number(0.1));
  mesh.set("scale", Params::make_number(3));
  const std::vector<EdgeLength> found = edge_lengths(table("mesh", mesh));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].path, "mesh.edge_length");
  EXPECT_EQ(found[1].length, 0.1);

  Params parts = Params::make_list();
  parts.push(table("shape", table("box", table("edge_length", Params::make_number(0.3)))));
  parts.push(table("shape", table("sphere", table("edge_length", Params::make_number(0.4)))));
  const std::vector<EdgeLength> of_parts = edge_lengths(table("parts", parts));
  ASSERT_EQ(of_parts.size(), 2u);
  EXPECT_EQ(of_parts[1].path, "parts.1.shape.sphere.edge_length");
  EXPECT_TRUE(edge_lengths(table("box", table("edge_length", Params::make_text("auto")))).empty());
}

}  // namespace
}  // namespace mortise::scene
