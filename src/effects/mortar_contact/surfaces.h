#pragma once
// Which surfaces a scene lets meet: its interfaces, each between a slave and a master, and the triangles of both.
#include <string>
#include <vector>

#include "base/param_table.h"
#include "effects/contact/pairs.h"
#include "effects/mortar_contact/frozen.h"
#include "effects/mortar_contact/stiffness.h"

namespace mortise::effects::mortar {

class Surfaces {
 public:
  // d_hat: per environment [m]. Throws Error (Exit::scene) where a pair cannot be.
  Surfaces(const Params& p, const model::Model& model, const std::vector<double>& d_hat);

  // Interfaces are listed pair by pair, in every environment.
  const std::vector<Interface>& interfaces() const { return interfaces_; }
  // Of a body, or of the half-space whose number is that beyond those of bodies.
  const std::string& name_of(Index body) const;
  // Of all interfaces.
  void scale_d_hat(double by);
  // What has to be kept apart. Once all supports are set.
  contact::WatchedPairs watched() const;

  View<const Index> interface_at() const { return interface_at_.view(); }   // per pair of bodies or half-spaces: interface, or -1
  View<const double> d_hat() const { return d_hat_.view(); }                // per interface [m]
  View<const std::uint8_t> directed() const { return directed_.view(); }    // per pair of bodies: slave, master
  View<const Index> slaves() const { return slaves_.view(); }               // triangles, environments contiguous
  const std::vector<Index>& slave_env() const { return slave_env_; }        // first slave,
  const std::vector<Index>& triangle_env() const { return triangle_env_; }  // and first triangle, of every environment
  Search& search() { return search_; }
  const Search& search() const { return search_; }

 private:
  void choose_pairs(const Params& p, const std::vector<double>& d_hat);
  void choose_triangles();

  const model::Model& model_;
  std::vector<Interface> interfaces_;
  Buffer<Index> interface_at_, slaves_;
  Buffer<double> d_hat_;
  Buffer<std::uint8_t> directed_;
  std::vector<Index> slave_env_, triangle_env_;
  Search search_;
};

}  // namespace mortise::effects::mortar
