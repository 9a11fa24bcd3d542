#pragma once
// YAML text -> checked tree of parameters with every default filled in and every number in SI. This folder knows no physics:
// the blocks of the scene are tables.cpp, the effects come in from outside.
//
// Conventions by key, checked for every block: `body`, `bodies`, `pairs`, `slave`, `master`, `a`, `b` and `to` name bodies, `material`
// names a material, `follows` names another effect of the scene.
#include <span>
#include <string>
#include <vector>

#include "base/param_table.h"
#include "base/params.h"
#include "scene/diagnostics.h"

namespace mortise::scene {

// One effect that scenes may name.
struct EffectTable {
  std::string name;
  std::string help;  // one sentence
  const ParamTable* table = nullptr;
  std::vector<std::string> point_fields{}, cell_fields{};  // that it reports
  bool inertia = false;                                    // makes a scene dynamic
  bool contact = false;                                    // keeps bodies apart, from `d_hat` on
  bool ties = false;  // a list, whose entries tie `body` and `to` (without it the world), which pass through each other unless `contact` is true
};

struct Scene {
  Params root;
  std::string path;  // as given; "-" = standard input
  std::string text;  // the file, byte for byte
};

// When it ends: the time of its last step [s], 1 in statics.
double end_time(const Params& root);

// Reads a scene file ("-" = standard input) and applies `overrides` ("a.b.c=value", value in YAML, the right-most wins).
// Paths inside the scene are returned absolute, taken relative to the scene's folder.
// Throws SceneErrors with everything that is wrong, Error(Exit::file) when the file cannot be read, Error(Exit::usage) when an
// override is not of the form path=value.
Scene read_scene(const std::string& path_or_dash, const std::vector<std::string>& overrides, std::span<const EffectTable> effects);

// The same for text in memory; `path` is what messages cite and what relative paths resolve against.
Scene read_scene_text(const std::string& text, const std::string& path, const std::vector<std::string>& overrides,
                      std::span<const EffectTable> effects);

// The resolved tree as a scene file again: all defaults written out, numbers in SI. Reading it gives the same tree.
std::string to_yaml(const Params& root);

// SHA-256 of that file, with the content of every file that it names (mesh, texture) in the place of the path: what decides whether two runs
// are of the same scene.
std::string identity(const Params& root);

}  // namespace mortise::scene
