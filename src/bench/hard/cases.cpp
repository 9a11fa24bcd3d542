// The scenes of the hard cases: variants are made from the text of one file.
#include <yaml-cpp/yaml.h>

#include <filesystem>

#include "base/error.h"
#include "bench/hard/dice.h"
#include "bench/hard/hard.h"

namespace fs = std::filesystem;

namespace mortise::bench::hard {
namespace {

// Mesh files by their absolute path, because the derived scene lies elsewhere.
void absolute_paths(YAML::Node node, const fs::path& folder) {
  if (node.IsSequence())
    for (YAML::Node item : node) absolute_paths(item, folder);
  if (!node.IsMap()) return;
  for (auto entry : node) {
    if (entry.first.as<std::string>() == "file" && entry.second.IsScalar())
      node["file"] = (folder / entry.second.as<std::string>()).lexically_normal().string();
    else
      absolute_paths(entry.second, folder);
  }
}

void put(YAML::Node node, const std::string& path, const YAML::Node& value) {
  const std::size_t dot = path.find('.');
  const std::string key = path.substr(0, dot);
  if (dot != std::string::npos) {
    if (node.IsSequence())
      put(node[std::stoul(key)], path.substr(dot + 1), value);
    else
      put(node[key], path.substr(dot + 1), value);
  } else if (node.IsSequence()) {
    node[std::stoul(key)] = value;
  } else {
    node[key] = value;
  }
}

void apply(YAML::Node scene, const YAML::Node& sets) {
  for (const auto& item : sets) {
    const std::string text = item.as<std::string>();
    const std::size_t equals = text.find('=');
    put(scene, text.substr(0, equals), YAML::Load(text.substr(equals + 1)));
  }
}

void use_mortar(YAML::Node scene, const YAML::Node& mortar) {
  YAML::Node effects = scene["effects"];
  const YAML::Node barrier = effects["barrier_contact"];
  YAML::Node block = YAML::Clone(mortar);
  block["d_hat"] = barrier["d_hat"];
  effects.remove("barrier_contact");
  effects["mortar_contact"] = block;
  if (effects["friction"]) effects["friction"]["follows"] = "mortar_contact";
}

}  // namespace

std::vector<Case> cases_of(const std::string& path, bool full) {
  try {
    const YAML::Node base = YAML::LoadFile(path);
    const YAML::Node hard = base["x-hard"];
    const std::string name = base["name"].as<std::string>();
    std::vector<std::pair<std::string, YAML::Node>> variants{{"", YAML::Node(YAML::NodeType::Sequence)}};
    if (hard && hard["variants"])
      for (const auto& v : hard["variants"]) variants.emplace_back(v.first.as<std::string>(), v.second);
    std::vector<Case> out;
    for (const auto& [variant, sets] : variants)
      for (const char* method : {"barrier", "mortar"}) {
        const bool mortar = method[0] == 'm';
        if (mortar && (!hard || !hard["mortar"] || (!variant.empty() && !full))) continue;
        YAML::Node scene = YAML::Clone(base);
        scene.remove("x-hard");
        absolute_paths(scene, fs::absolute(path).parent_path());
        if (full && hard && hard["full"]) apply(scene, hard["full"]);
        apply(scene, sets);
        if (mortar) use_mortar(scene, hard["mortar"]);
        if (mortar && hard["mortar_checks"])
          for (const auto& check : hard["mortar_checks"]) scene["checks"].push_back(check);
        scene["output"]["precision"] = "double";
        Case c{name, method, variant, "", false};
        if (hard && hard["reported"] && hard["reported"][method]) c.reported = hard["reported"][method].as<std::vector<std::string>>();
        for (const auto& check : scene["checks"]) c.expects_failure |= check["is"] && check["is"].as<std::string>() != "done";
        c.text = emit(scene);
        out.push_back(std::move(c));
      }
    return out;
  } catch (const YAML::Exception& e) {
    throw Error(Exit::scene, path + ": " + e.what());
  }
}

}  // namespace mortise::bench::hard
