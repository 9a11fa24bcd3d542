#pragma once
#include "study/run_study.h"

namespace mortise::study {

// A scene without one of its effects, and without those that follow it.
struct WithoutEffect {
  std::vector<std::string> effects;  // the one, then its followers; none: the scene as it is
  std::string needed;                // why the scene makes no sense without it; empty where it does
  RunResult run;
};

// Runs the scene as it is, and with each effect off in turn.
std::vector<WithoutEffect> run_without_effects(const Study& study, const Place& place, const Told& told);

std::string effects_table(const Study& study, const std::vector<WithoutEffect>& runs);
std::string effects_csv(const Study& study, const std::vector<WithoutEffect>& runs);

}  // namespace mortise::study
