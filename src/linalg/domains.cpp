#include "linalg/domains.h"

#include <algorithm>
#include <map>

namespace mortise::linalg {
namespace {

// Items that stay together: a node, an affine body, a coarse item.
struct Atom {
  Vec3 place;
  Index first = 0, items = 0, blocks = 0;
};

struct Items {
  std::vector<Index> env, body;
  std::vector<Vec3> place;
  Index size() const { return static_cast<Index>(env.size()); }
};

Items rows_as_items(const RowPlaces& rows, const std::vector<Index>& env_rows) {
  Items out{{}, rows.body, rows.place};
  for (std::size_t e = 0; e + 1 < env_rows.size(); ++e) out.env.insert(out.env.end(), env_rows[e + 1] - env_rows[e], static_cast<Index>(e));
  return out;
}

// Neighbouring items of one body at the same place are one atom.
std::vector<Atom> atoms_of(const Items& items, Index begin, Index end, Index width) {
  constexpr Index kMost = 4;  // an affine body
  std::vector<Atom> out;
  for (Index i = begin; i < end; ++i) {
    if (width == 1 && !out.empty() && out.back().items < kMost && out.back().place == items.place[i] && items.body[i] == items.body[i - 1])
      ++out.back().items, ++out.back().blocks;
    else
      out.push_back({items.place[i], i, 1, width});
  }
  return out;
}

// Puts the atoms [begin, end) into domains of about equal size; `close` is called with the atoms of every domain.
template <class Close>
void split(std::vector<Atom>& atoms, std::size_t begin, std::size_t end, const Close& close) {
  Index blocks = 0;
  Vec3 lo = atoms[begin].place, hi = lo;
  for (std::size_t i = begin; i < end; ++i) {
    blocks += atoms[i].blocks;
    lo = lo.cwiseMin(atoms[i].place), hi = hi.cwiseMax(atoms[i].place);
  }
  if (blocks <= kSlots) {
    std::sort(atoms.begin() + begin, atoms.begin() + end, [](const Atom& a, const Atom& b) { return a.first < b.first; });
    close(begin, end);
    return;
  }
  int axis = 0;
  (hi - lo).maxCoeff(&axis);
  std::sort(atoms.begin() + begin, atoms.begin() + end,
            [axis](const Atom& a, const Atom& b) { return a.place[axis] != b.place[axis] ? a.place[axis] < b.place[axis] : a.first < b.first; });
  const Index domains = (blocks + kSlots - 1) / kSlots;
  const Index wanted = static_cast<Index>(static_cast<long long>(blocks) * (domains / 2) / domains);
  std::size_t cut = begin;
  for (Index left = 0; cut + 1 < end && (cut == begin || left + atoms[cut].blocks <= wanted); ++cut) left += atoms[cut].blocks;
  split(atoms, begin, cut, close);
  split(atoms, cut, end, close);
}

// The items of one domain become items of the next level: one per body, or a single one where bodies are too many to get coarser so.
void coarsen(const Items& items, const std::vector<Index>& domain, DomainLevel& level, Items& next) {
  std::map<Index, std::vector<Index>> of_body;
  for (Index i : domain) of_body[items.body[i]].push_back(i);
  if (of_body.size() > domain.size() / 4) of_body = {{items.body[domain[0]], domain}};
  for (const auto& [body, members] : of_body) {
    Vec3 place = Vec3::Zero();
    for (Index i : members) {
      place += items.place[i] / static_cast<double>(members.size());
      level.parent[i] = next.size();
      level.member.push_back(i);
    }
    level.member_start.push_back(static_cast<Index>(level.member.size()));
    next.env.push_back(items.env[members[0]]);
    next.body.push_back(body);
    next.place.push_back(place);
  }
}

// One level: the domains of every environment, and the items of the next level.
Items add_level(const Items& items, Index width, Domains& out) {
  DomainLevel level;
  level.slot.resize(items.size());
  level.parent.assign(items.size(), -1);
  level.member_start = {0};
  Items next;
  for (Index begin = 0, end = 0; begin < items.size(); begin = end) {
    while (end < items.size() && items.env[end] == items.env[begin]) ++end;
    std::vector<Atom> atoms = atoms_of(items, begin, end, width);
    std::vector<std::vector<Index>> domains;
    split(atoms, 0, atoms.size(), [&](std::size_t from, std::size_t to) {
      domains.emplace_back();
      for (std::size_t a = from; a < to; ++a)
        for (Index i = 0; i < atoms[a].items; ++i) domains.back().push_back(atoms[a].first + i);
    });
    for (const std::vector<Index>& domain : domains) {
      Index slot = static_cast<Index>(out.blocks.size()) * kSlots;
      for (Index i : domain) level.slot[i] = slot, slot += width;
      out.blocks.push_back(static_cast<Index>(domain.size()) * width);
      if (domains.size() > 1) coarsen(items, domain, level, next);
    }
  }
  out.levels.push_back(std::move(level));
  return next;
}

}  // namespace

Domains make_domains(const RowPlaces& rows, const std::vector<Index>& env_rows) {
  Domains out;
  Items items = add_level(rows_as_items(rows, env_rows), 1, out);
  out.fine = static_cast<Index>(out.blocks.size());
  while (items.size() > 0) items = add_level(items, 2, out);
  return out;
}

}  // namespace mortise::linalg
