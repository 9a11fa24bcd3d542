#pragma once
// How ties hold at the accepted state. With g the gradient of all effects [N], an equation q_b = sum_k t_bk q_k + h_b pulls its block with
//
//     lambda_b = g_b + sum_{c follows b} t_cb lambda_c      and every q_k that it follows with -t_bk lambda_b:
//
// what the blocks behind it hand on comes first. Force and moment of a tie are those of the pulls on the blocks of its first body: a stiff body that
// is pulled with f on (p, a1, a2, a3) feels the force f_p and about the place x the moment (p - x) x f_p + sum_i a_i x f_i.
#include "base/field_sinks.h"
#include "model/model.h"

namespace mortise::solver {

class TieForces {
 public:
  TieForces(const model::Model& model, const std::vector<Vec3>& q, std::vector<Vec3> gradient);

  const std::vector<Vec3>& on_bodies() const { return on_body_; }  // of all ties [N]
  Vec3 of_effect(std::string_view effect, Index env) const;        // on all bodies of an environment: what the world bears [N]
  void report(const FieldSinks& sinks) const;

 private:
  struct Figures {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero(), place;  // on its first body [N], [N m]; about here [m]
    Vec3 on_all = Vec3::Zero();                               // on both [N]
    Vec3 axis;                                                // of a driven one: now
    double error = 0;                                         // by how far its equations are missed [m]; of axes times the radius of their body
  };
  std::vector<double> motors() const;  // of every tie; zero of those that are not driven [N m, N]

  const model::Model& model_;
  std::vector<Figures> of_;  // every tie
  std::vector<Vec3> on_body_;
  std::vector<Vec3> pull_;  // of all ties, on every block
};

}  // namespace mortise::solver
