#include "effects/pressure_load/pressure_load.h"

#include <map>
#include <utility>

#include "base/complaints.h"
#include "effects/body_blocks.h"
#include "effects/list.h"
#include "effects/pressure_load/loaded_part.h"
#include "effects/where.h"
#include "model/points_of.h"
#include "model/select.h"

namespace mortise::effects {
namespace {

using param::of;
using param::optional;
using pressure_load::BlockLoad;
using pressure_load::Strength;

const ParamTable kTable = [] {
  ParamTable t{"effect pressure_load",
               "Dead load on a part of a surface.",
               {of(Param::Kind::text, "body", Unit::none, std::nullopt, "Name of the body."),
                param::required(param::table("where", &where_table, "Loaded is what of the surface lies inside: a box or a sphere cuts triangles.")),
                optional(of(Param::Kind::schedule, "pressure", Unit::pressure, std::nullopt,
                            "Force per rest area against the outward rest normal, over time (pseudo-time 0 to 1 in static scenes).")),
                optional(of(Param::Kind::vec3, "traction", Unit::pressure, std::nullopt, "Force vector per rest area.")),
                of(Param::Kind::schedule, "traction_factor", Unit::none, "1", "Factor of the traction over time.")}};
  t.is_list = true;
  return t;
}();

struct Load {
  Schedule pressure, factor;
};

class PressureLoad final : public Effect {
 public:
  PressureLoad(const Params& list, model::Model& model) : model_(model) {
    // Ordered by block, so that environments are contiguous; then by load.
    std::map<std::pair<Index, Index>, BlockLoad> loads_of;
    Complaints wrong;
    for (Index e = 0; e < model.envs; ++e)
      for (std::size_t l = 0; l < list.items().size(); ++l)
        wrong.gather([&] { add(model.input.effect_of(list, e).items()[l], e, static_cast<Index>(l), loads_of); });
    wrong.raise();
    const std::vector<Index> env = model.block_env.download();
    std::vector<BlockLoad> flat;
    std::vector<Index> loaded_env;
    for (const auto& [key, load_of] : loads_of) flat.push_back(load_of), loaded_env.push_back(env[load_of.block]);
    loaded_.upload(flat);
    env_offset_ = env_offsets(loaded_env, model.envs);
    strengths_.resize(loads_.size());
    set_time({});
  }

  const Kind& kind() const override;
  std::vector<PlanItem> plan() const override { return {{"loaded blocks", loaded_.bytes() + strength_.bytes()}}; }

  void begin_step(const StepInfo& step) override { set_time(step); }

  void energy(Positions q, const Linearisation&, device::EnvValues per_env) override {
    const View<const BlockLoad> load_of = std::as_const(loaded_).view();
    const View<const Strength> now = std::as_const(strength_).view();
    const View<const Index> env = std::as_const(model_.block_env).view();
    const Index loads = loads_each();
    const Positions rest = std::as_const(model_.rest).view();
    device::env_sum(
        "pressure_load.energy", env_offset_,
        [=] MORTISE_HD(Index i) {
          const BlockLoad s = load_of[i];
          return pressure_load::energy(pressure_load::force(s, now[env[s.block] * loads + s.load]), q[s.block], rest[s.block]);
        },
        per_env);
  }

  void linearise(Positions, Want want, Linearisation& at) override {
    if (!want.forces) return;
    const bool fresh = at.stencils.resize_uniform(loaded_.size(), 1);
    const bool stiffness = want.matrix.wanted && !at.stencils.has_hessian();
    if (stiffness) at.stencils.need_hessian();
    const View<const BlockLoad> load_of = std::as_const(loaded_).view();
    const View<const Strength> now = std::as_const(strength_).view();
    const View<const Index> env = std::as_const(model_.block_env).view();
    const Index loads = loads_each();
    const linalg::StencilView out = at.stencils.view();
    device::parallel_for("pressure_load.assemble", load_of.n, [=] MORTISE_HD(Index i) {
      out.block[i] = load_of[i].block;
      out.grad[i] = -pressure_load::force(load_of[i], now[env[load_of[i].block] * loads + load_of[i].load]);
      if (stiffness) out.hess[i] = Mat3::Zero();
    });
    if (fresh) at.stencils.pattern_changed();
  }

  // Resultant force of all loads now.
  void report(const FieldSinks& sinks, const Linearisation&) override {
    const std::vector<Strength>& now = strengths_;
    const std::vector<Index> env = model_.block_env.download();
    const Index loads = loads_each();
    const std::vector<double> translation = translation_weight(model_);
    std::vector<Vec3> total(model_.envs, Vec3::Zero());
    for (const BlockLoad& s : loaded_.download())
      total[env[s.block]] += translation[s.block] * pressure_load::force(s, now[env[s.block] * loads + s.load]);
    for (Index e = 0; e < sinks.size(); ++e)
      for (int a = 0; a < 3; ++a) sinks[e].scalar("pressure_load", std::string("force_") + "xyz"[a], "N", total[e][a]);
  }

 private:
  // To the end of the step.
  void set_time(const StepInfo& step) {
    for (Index e = 0; e < model_.envs; ++e)
      for (Index l = e * loads_each(); step.taken_by(e) && l < (e + 1) * loads_each(); ++l)
        strengths_[l] = {loads_[l].pressure(step.t1_of(e)), loads_[l].factor(step.t1_of(e))};
    strength_.upload(strengths_);
  }

  Index loads_each() const { return static_cast<Index>(loads_.size()) / model_.envs; }

  void add(const Params& p, Index in, Index load, std::map<std::pair<Index, Index>, BlockLoad>& loads_of) {
    const Params* pressure = p.find("pressure");
    const Params* traction = p.find("traction");
    if (!pressure && !traction) throw Error(Exit::scene, p.where(), "a load needs 'pressure' or 'traction'");
    loads_.push_back({Schedule(pressure ? *pressure : Params::make_number(0)), Schedule(p.at("traction_factor"))});
    bool found = false;
    for (const model::Body& body : model_.bodies) {
      if (body.env != in || body.name != p.text("body")) continue;
      found = true;
      if (!add_body(p, body, load, traction ? traction->as_vec3() : Vec3(0, 0, 0), loads_of))
        model::selects_nothing(p.at("where"), p.at("where").has("side") ? "whole surface triangle" : "part of the surface", body.name,
                               model::points_of(body, model_.rest_points.download()));
    }
    if (!found) throw Error(Exit::scene, p.at("body").where(), "no soft or stiff body is named '" + p.text("body") + "'");
  }

  bool add_body(const Params& p, const model::Body& body, Index load, const Vec3& traction, std::map<std::pair<Index, Index>, BlockLoad>& loads_of) {
    const auto triangles = model_.surface.triangles.download();
    const auto faces = model_.faces.nodes.download();
    const auto quarter = model_.faces.quarter.download();
    const auto rest = model_.rest_points.download();
    const auto offset = model_.point_offset.download(), block = model_.point_block.download();
    const auto weight = model_.point_weight.download();
    // N [m^2] and N n [m^2] integrated over the triangle, at one of its points.
    const auto spread = [&](Index point, double area, const Vec3& directed) {
      for (Index j = offset[point]; j < offset[point + 1]; ++j) {
        BlockLoad& s = loads_of.try_emplace({block[j], load}, BlockLoad{block[j], load, Vec3::Zero(), Vec3::Zero()}).first->second;
        s.pushed -= weight[j] * directed;
        s.pulled += weight[j] * area * traction;
      }
    };
    const std::vector<pressure_load::Polygon> parts = pressure_load::loaded_parts(
        model_, body, std::span(triangles).subspan(body.triangle_begin, body.triangle_end - body.triangle_begin), rest, p.at("where"));
    bool any = false;
    for (Index t = body.triangle_begin; t < body.triangle_end; ++t) {
      const pressure_load::Polygon& part = parts[t - body.triangle_begin];
      if (part.empty()) continue;
      any = true;
      if (!quarter.empty() && quarter[t] >= 0) {
        const geometry::Face& face = faces[quarter[t] / 4];
        Vec3 x[6];
        for (int k = 0; k < 6; ++k) x[k] = rest[face.v[k]];
        for (std::size_t i = 2; i < part.size(); ++i) {
          const Mat3 corners = (Mat3() << part[0], part[i - 1], part[i]).finished();
          const pressure_load::QuarterLoad load_of = pressure_load::quarter_load(x, quarter[t] % 4, corners);
          for (int k = 0; k < 6; ++k) spread(face.v[k], load_of.area[k], load_of.directed[k]);
        }
        continue;
      }
      const Index* v = triangles[t].v;
      const Vec3 area = 0.5 * (rest[v[1]] - rest[v[0]]).cross(rest[v[2]] - rest[v[0]]);  // A n
      const pressure_load::Share share = pressure_load::share_of(part);
      for (int k = 0; k < 3; ++k) spread(v[k], share.area * share.mean[k] * area.norm(), share.area * share.mean[k] * area);
    }
    return any;
  }

  model::Model& model_;
  std::vector<Load> loads_;  // of every environment
  device::Buffer<BlockLoad> loaded_;
  std::vector<Strength> strengths_;  // of every load in every environment, at the end of its step
  device::Buffer<Strength> strength_;
  std::vector<Index> env_offset_;
};

}  // namespace

const Kind& pressure_load_kind() {
  static const Kind kind = Kind{
      "pressure_load", Role::load, "dead pressure or traction on a surface", &kTable,
      [](const Params& p, model::Model& m) -> std::unique_ptr<Effect> {
        return std::make_unique<PressureLoad>(p, m);
      }}.differing_in({"pressure", "traction", "traction_factor"});
  return kind;
}

const Kind& PressureLoad::kind() const { return pressure_load_kind(); }

}  // namespace mortise::effects
