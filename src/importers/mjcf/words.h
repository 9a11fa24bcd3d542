#pragma once
// The words of MJCF: those that are read, and those that are known and left out with a note. What is in neither list is told as unknown.
#include <map>
#include <string>
#include <vector>

#include "importers/mjcf/compiler.h"

namespace mortise::importers::mjcf::words {

using Words = std::vector<std::string>;

inline Words together(Words a, const Words& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
inline Words with_pose(const Words& more) { return together(more, pose_words()); }

inline const Words sections{"compiler", "default", "asset", "worldbody", "contact", "equality", "tendon", "actuator", "keyframe"};
inline const Words dropped_sections{"option", "size", "visual", "statistic", "custom", "extension", "sensor", "deformable"};

inline const Words in_body{"inertial", "joint", "freejoint", "geom", "body", "frame"};
inline const Words dropped_in_body{"site",   "camera",    "light",    "composite", "flexcomp", "plugin",
                                   "attach", "replicate", "gravcomp", "mocap",     "user",     "sleep"};

// What only pictures, MuJoCo's broad phase or its solver need is read over without a word: it says nothing about the robot.
inline const Words geom{"name",   "class", "type",     "contype",  "conaffinity", "group",  "size",   "material", "rgba",   "mass", "density",
                        "fromto", "mesh",  "fitscale", "priority", "condim",      "solmix", "solref", "solimp",   "margin", "gap",  "user"};
inline const Words dropped_geom{"friction", "shellinertia", "hfield", "fluidshape", "fluidcoef"};
inline const Words joint{"name",
                         "class",
                         "type",
                         "group",
                         "pos",
                         "axis",
                         "range",
                         "limited",
                         "actuatorfrcrange",
                         "actuatorfrclimited",
                         "ref",
                         "damping",
                         "stiffness",
                         "springref",
                         "armature",
                         "frictionloss",
                         "margin",
                         "solreflimit",
                         "solimplimit",
                         "solreffriction",
                         "solimpfriction",
                         "user"};
inline const Words dropped_joint{"springdamper", "actuatorgravcomp"};

// A fixed tendon says which joints an actuator pulls. Springs, limits and resistance of tendons are left out.
inline const Words tendon{"name",           "class",  "group", "solreflimit", "solimplimit", "solreffriction",
                          "solimpfriction", "margin", "width", "material",    "rgba",        "user"};
inline const Words dropped_tendon{"range",        "limited",  "stiffness",        "damping",           "frictionloss",
                                  "springlength", "armature", "actuatorfrcrange", "actuatorfrclimited"};

// Attributes that stand in classes of defaults.
inline const std::map<std::string, std::pair<Words, Words>> of_defaults{
    {"geom", {with_pose(geom), dropped_geom}},
    {"joint", {joint, dropped_joint}},
};

}  // namespace mortise::importers::mjcf::words
