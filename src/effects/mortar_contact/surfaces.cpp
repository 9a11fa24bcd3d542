#include "effects/mortar_contact/surfaces.h"

#include "base/error.h"
#include "effects/body_blocks.h"

namespace mortise::effects::mortar {

Surfaces::Surfaces(const Params& p, const model::Model& model, const std::vector<double>& d_hat) : model_(model) {
  choose_pairs(p, d_hat);
  scale_d_hat(1);
  choose_triangles();
}

void Surfaces::scale_d_hat(double by) {
  std::vector<double> d_hat;
  for (Interface& i : interfaces_) d_hat.push_back(i.d_hat *= by);
  d_hat_.upload(d_hat);
}

void Surfaces::choose_pairs(const Params& p, const std::vector<double>& d_hat) {
  const bool two_pass = p.flag("two_pass"), set = p.has("d_hat");
  const Index n = static_cast<Index>(model_.bodies.size()), planes = static_cast<Index>(model_.half_spaces.size());
  const geometry::BodyPairs& pairs = model_.surface.pairs;
  std::vector<Index> interface_of_pair(pairs.size(planes), -1);
  std::vector<std::uint8_t> directed(pairs.size(0), 0);
  const auto add = [&](Index slave, Index master, const SourceLoc& at) {
    if (interface_of_pair[pairs.of(slave, master)] >= 0) throw Error(Exit::scene, at, "this pair is listed twice");
    interface_of_pair[pairs.of(slave, master)] = static_cast<Index>(interfaces_.size());
    if (master < n) directed[pairs.of(slave, master)] = 1;
    interfaces_.push_back(interface_of(model_, slave, master, d_hat[model_.bodies[slave].env], set));
  };
  for (const Params& pair : p.at("pairs").items()) {
    const std::string &slave = pair.text("slave"), &master = pair.text("master");
    std::vector<Index> slaves = model_.bodies_named(slave);
    std::erase_if(slaves, [&](Index a) { return a >= n; });
    const std::vector<Index> masters = model_.bodies_named(master);
    if (slaves.empty()) throw Error(Exit::scene, pair.at("slave").where(), "no soft or stiff body is called '" + slave + "'");
    if (masters.empty()) throw Error(Exit::scene, pair.at("master").where(), "no body is called '" + master + "'");
    if (slave == master) throw Error(Exit::scene, pair.where(), "a body cannot be its own master: use barrier_contact for self-contact");
    for (Index a : slaves)
      for (Index b : masters) {
        if (!model_.same_env(a, b)) continue;
        add(a, b, pair.where());
        if (two_pass && b < n) add(b, a, pair.where());
      }
  }
  interface_at_.upload(interface_of_pair);
  directed_.upload(directed);
}

void Surfaces::choose_triangles() {
  const Index n = static_cast<Index>(model_.bodies.size());
  std::vector<std::uint8_t> is_slave(n, 0), is_master(n, 0);
  for (const Interface& i : interfaces_) {
    is_slave[i.slave] = 1;
    if (i.master < n) is_master[i.master] = 1;
  }
  std::vector<Index> slaves, masters, env, master_env, triangle_env;  // bodies are in order of environment
  for (Index b = 0; b < n; ++b)
    for (Index t = model_.bodies[b].triangle_begin; t < model_.bodies[b].triangle_end; ++t) {
      const Index e = model_.bodies[b].env;
      triangle_env.push_back(e);
      if (is_slave[b]) slaves.push_back(t), env.push_back(e);
      if (is_master[b]) masters.push_back(t), master_env.push_back(e);
    }
  slaves_.upload(slaves);
  slave_env_ = env_offsets(env, model_.envs);
  triangle_env_ = env_offsets(triangle_env, model_.envs);
  search_ = Search(slave_env_, masters, env_offsets(master_env, model_.envs), model_.surface.triangles.download());
}

const std::string& Surfaces::name_of(Index body) const {
  const auto n = static_cast<Index>(model_.bodies.size());
  return body < n ? model_.bodies[body].name : model_.half_spaces[body - n].name;
}

contact::WatchedPairs Surfaces::watched() const {
  contact::WatchedPairs pairs(model_);
  for (const Interface& i : interfaces_) pairs.set(i.slave, i.master, contact::Watch::contact);
  contact::complete(model_, pairs);
  return pairs;
}

}  // namespace mortise::effects::mortar
