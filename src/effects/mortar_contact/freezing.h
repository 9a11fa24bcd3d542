#pragma once
// Takes the samples at a position, in two halves, between which one fetch brings what only the device counts.
#include <optional>

#include "device/room.h"
#include "effects/mortar_contact/stage.h"

namespace mortise::effects::mortar {

// Room for candidates and for their offers, among so many slaves. What is near varies from the beginning of a step to its end, and places that stay
// empty are only passed over: room is given up slowly.
struct FreezeRoom {
  device::Room candidates, offers;
  static constexpr double kKept = 0.97;
};

class Freezing {
 public:
  // The samples at out.y with a gap below support + margin[env]. map: where the sizes of their stencils are wanted, or null. What is referred to must
  // stay until the end.
  void begin(const MortarView& s, Search& search, const Buffer<double>& margin, const FreezeRoom& room, const model::PointMapView* map,
             FrozenSamples& out, device::Fetch& fetch);
  // And, where wanted, how they move, which asks for the map. False: the room was too small, which it is no more.
  bool end(FreezeRoom& room, Moving moving);

 private:
  Search* search_ = nullptr;
  FrozenSamples* out_ = nullptr;
  std::optional<Stage> stage_;
  model::PointMapView map_;
  Buffer<Patch> patches_;
  Buffer<Facing> facing_;
  Buffer<std::uint8_t> near_, layered_;
  Buffer<Index> offers_at_, kept_at_;  // offsets of the offers of every piece of every candidate, and of the offers that are samples
  Buffer<Sample> offers_;
  Buffer<Index> counts_;         // of every candidate, one list after the other (freeze.cpp), added up through all of them
  std::vector<Index> list_end_;  // what they add up to at the end of every list
  Index offered_ = 0;
};

// Both at once: the host waits once, as a rule.
void freeze(const MortarView& s, Search& search, const Buffer<double>& margin, FreezeRoom& room, const model::PointMapView* map, Moving moving,
            FrozenSamples& out);

}  // namespace mortise::effects::mortar
