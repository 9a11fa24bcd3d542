#pragma once
// How ties hold at the accepted state. With g the gradient of all effects [N], an equation q_b = sum_k t_bk q_k + h_b pulls its block with
//
//     lambda_b = g_b + sum_{c follows b} t_cb lambda_c      and every q_k that it follows with -t_bk lambda_b:
//
// what the blocks behind it hand on comes first. Force and moment of a tie are those of the pulls on the blocks of its first body: a stiff body that
// is pulled with f on (p, a1, a2, a3) feels the force f_p and about the place x the moment (p - x) x f_p + sum_i a_i x f_i.
//
// A slide on what goes as it is told is held across its axis by a support (model/joints.h). What that bears, f = (I - P) g_p at the slider's centre,
// is borne by the body that carries it, at the place where that centre is, and by what holds that.
#include <cstdint>
#include <optional>

#include "base/field_sinks.h"
#include "model/model.h"

namespace mortise::solver {

class TieForces {
 public:
  // gradient: of all effects [N].
  TieForces(const model::Model& model, std::vector<Vec3> q, std::vector<Vec3> gradient);

  const std::vector<Vec3>& on_bodies() const { return on_body_; }  // of all ties and slides [N]
  Vec3 of_effect(std::string_view effect, Index env) const;        // on all bodies of an environment: what the world bears [N]
  // What slides take from the blocks of sliders and hand on to those that carry them and follow nothing, as a gradient [N]; empty without slides.
  const std::vector<Vec3>& handed_on() const { return handed_; }
  // Is it the centre of a slider that a body carries? No support bears anything there.
  bool carried(Index block) const { return !carried_.empty() && carried_[block] != 0; }
  void report(const FieldSinks& sinks) const;

 private:
  struct Figures {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero(), place;  // on its first body [N], [N m]; about here [m]
    Vec3 on_all = Vec3::Zero();                               // on both [N]
    Vec3 axis;                                                // of a driven one: now
    double error = 0;                                         // by how far its equations are missed [m]; of axes times the radius of their body
    std::optional<Vec3> guide{};                              // of a slide across whose axis a support holds: that, on its first body [N]
  };
  Vec3 place_of(const model::Follow& f) const;
  // The equation f of a tie holds its block with `force`, and hands on to those that it follows.
  void hold(std::size_t tie, const model::Follow& f, const Vec3& force, std::vector<Vec3>& gradient);
  void pull(std::size_t tie, Index block, const Vec3& force);
  // folded: of blocks that follow nothing.
  void guide(const std::vector<Vec3>& folded);
  std::vector<double> motors() const;  // of every tie; zero of those that are not driven [N m, N]

  const model::Model& model_;
  const std::vector<Vec3> q_;
  std::vector<double> position_;  // of every block: its share in the place of its body
  std::vector<Index> body_;       // of every block
  std::vector<Figures> of_;       // every tie
  std::vector<Vec3> on_body_;
  std::vector<Vec3> pull_;  // of all ties, on every block
  std::vector<Vec3> handed_;
  std::vector<std::uint8_t> carried_;  // of every block; empty without slides
};

}  // namespace mortise::solver
