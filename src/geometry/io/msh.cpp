#include "geometry/io/msh.h"

#include <algorithm>
#include <unordered_map>

#include "geometry/io/text.h"
#include "geometry/io/write.h"

namespace mortise::geometry {
namespace {

constexpr int kTriangle = 2, kTet = 4, kTriangle6 = 9, kTet10 = 11;

// Points and lines of any order carry no surface and no volume.
bool passed_over(long long type) { return type == 1 || type == 8 || type == 15 || (type >= 26 && type <= 28); }

class MshParser {
 public:
  MshParser(const std::string& path, std::string_view text) : in_(path, text) {}

  MshFile parse() {
    in_.require("$MeshFormat");
    if (in_.words()[0] != "$MeshFormat") in_.fail("not a Gmsh file: expected $MeshFormat");
    read_format();
    bool nodes = false, elements = false;
    while (in_.next()) {
      const std::string section(in_.words()[0]);
      if (section == "$Nodes") {
        nodes = true;
        four_ ? read_nodes_4() : read_nodes_2();
        end("$EndNodes");
      } else if (section == "$Elements") {
        if (!nodes) in_.fail("$Elements before $Nodes");
        elements = true;
        four_ ? read_elements_4() : read_elements_2();
        end("$EndElements");
      } else if (section[0] == '$') {
        const int begin = in_.line();
        const std::string last = "$End" + section.substr(1);
        do {
          if (!in_.next()) in_.fail_at(begin, "section " + section + " has no " + last);
        } while (in_.words()[0] != last);
      } else {
        in_.fail("expected a section ($Nodes, ...), found '" + section + "'");
      }
    }
    if (!nodes) in_.fail("the file has no $Nodes section");
    if (!elements) in_.fail("the file has no $Elements section");
    if (!out_.midsides.empty() && out_.midsides.size() != out_.tets.size()) in_.fail("tetrahedra of first and of second order in one file");
    return std::move(out_);
  }

 private:
  void end(const char* marker) {
    in_.require(marker);
    if (in_.words()[0] != marker) in_.fail(std::string("expected ") + marker + ", found '" + std::string(in_.words()[0]) + "'");
  }

  void read_format() {
    in_.require("the format version");
    const std::string version(in_.words()[0]);
    if (version[0] != '2' && version != "4.1") in_.fail("Gmsh format " + version + " is not supported; save as 2.2 or 4.1 (Mesh.MshFileVersion)");
    if (in_.integer(1, "the file type") != 0) in_.fail("binary Gmsh files are not supported; save as ASCII (Mesh.Binary = 0)");
    four_ = version[0] == '4';
    end("$EndMeshFormat");
  }

  long long count(std::size_t word, const char* what) {
    const long long n = in_.integer(word, what);
    if (n < 0 || n > 2'000'000'000) in_.fail(std::string(what) + " is out of range: " + std::to_string(n));
    return n;
  }

  void add_node(long long tag, std::size_t first) {
    if (!number_.emplace(tag, static_cast<Index>(out_.points.size())).second) in_.fail("node " + std::to_string(tag) + " is defined twice");
    out_.points.push_back(in_.vec3(first, "a coordinate"));
  }

  void read_nodes_2() {
    in_.require("the number of nodes");
    const long long n = count(0, "the number of nodes");
    for (long long i = 0; i < n; ++i) {
      in_.require("a node");
      add_node(in_.integer(0, "a node number"), 1);
    }
  }

  void read_nodes_4() {
    in_.require("the number of node blocks");
    const long long blocks = count(0, "the number of node blocks");
    for (long long b = 0; b < blocks; ++b) {
      in_.require("a node block");
      const long long n = count(3, "the number of nodes in the block");
      std::vector<long long> tags;
      for (long long i = 0; i < n; ++i) {
        in_.require("a node number");
        tags.push_back(in_.integer(0, "a node number"));
      }
      for (long long tag : tags) {
        in_.require("the coordinates of a node");
        add_node(tag, 0);
      }
    }
  }

  void add_element(long long type, std::size_t first) {
    const auto node = [&](std::size_t k) {
      const long long tag = in_.integer(first + k, "a node number");
      const auto found = number_.find(tag);
      if (found == number_.end()) in_.fail("node " + std::to_string(tag) + " is not defined");
      return found->second;
    };
    if (type == kTriangle || type == kTriangle6) {
      out_.triangles.push_back({{node(0), node(1), node(2)}});
    } else if (type == kTet || type == kTet10) {
      out_.tets.push_back({{node(0), node(1), node(2), node(3)}});
      // Gmsh numbers the edges (0,1) (1,2) (2,0) (0,3) (2,3) (1,3).
      if (type == kTet10) out_.midsides.push_back({{node(4), node(5), node(6), node(7), node(9), node(8)}});
    } else if (!passed_over(type)) {
      in_.fail("element type " + std::to_string(type) + " is not supported: only triangles (2, 9) and tetrahedra (4, 11) of first and second order");
    }
  }

  void read_elements_2() {
    in_.require("the number of elements");
    const long long n = count(0, "the number of elements");
    for (long long i = 0; i < n; ++i) {
      in_.require("an element");
      const long long tags = count(2, "the number of tags");
      add_element(in_.integer(1, "an element type"), 3 + tags);
    }
  }

  void read_elements_4() {
    in_.require("the number of element blocks");
    const long long blocks = count(0, "the number of element blocks");
    for (long long b = 0; b < blocks; ++b) {
      in_.require("an element block");
      const long long type = in_.integer(2, "an element type"), n = count(3, "the number of elements in the block");
      for (long long i = 0; i < n; ++i) {
        in_.require("an element");
        add_element(type, 1);
      }
    }
  }

  LineReader in_;
  bool four_ = false;
  std::unordered_map<long long, Index> number_;
  MshFile out_;
};

}  // namespace

MshFile parse_msh(const std::string& path, std::string_view text) { return MshParser(path, text).parse(); }

MshFile read_msh(const std::string& path) { return parse_msh(path, read_file(path)); }

void write_msh(const std::string& path, const MshFile& mesh) {
  std::string out = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" + std::to_string(mesh.points.size()) + "\n";
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    out += std::to_string(i + 1);
    append_numbers(out, mesh.points[i].data(), 3);
  }
  out += "$EndNodes\n$Elements\n" + std::to_string(mesh.triangles.size() + mesh.tets.size()) + "\n";
  std::size_t number = 0;
  const auto element = [&](const char* head, const Index* v, int n) {
    out += std::to_string(++number) + head;
    for (int k = 0; k < n; ++k) out += " " + std::to_string(v[k] + 1);
    out += "\n";
  };
  for (const Triangle& t : mesh.triangles) element(" 2 2 0 1", t.v, 3);
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    if (mesh.midsides.empty()) {
      element(" 4 2 0 1", mesh.tets[i].v, 4);
      continue;
    }
    const Index *c = mesh.tets[i].v, *m = mesh.midsides[i].v;
    const Index all[] = {c[0], c[1], c[2], c[3], m[0], m[1], m[2], m[3], m[5], m[4]};
    element(" 11 2 0 1", all, 10);
  }
  out += "$EndElements\n";
  write_file(path, out);
}

void write_msh(const std::string& path, const TetMesh& mesh) { write_msh(path, MshFile{mesh.points, {}, mesh.tets, mesh.midsides}); }

}  // namespace mortise::geometry
