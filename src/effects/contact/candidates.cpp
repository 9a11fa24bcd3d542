#include "effects/contact/candidates.h"

#include <cmath>
#include <utility>

#include "effects/contact/tuning.h"

namespace mortise::effects::contact {
namespace {

using device::View;

// Distance of y from the segment {from + a move, 0 <= a <= 1}.
MORTISE_HD inline double off_path(const Vec3& from, const Vec3& move, const Vec3& y) {
  const double mm = move.squaredNorm();
  double a = mm > 0 ? (y - from).dot(move) / mm : 0;
  a = a > 1 ? 1 : a < 0 ? 0 : a;
  return (y - from - a * move).norm();
}

// Largest distance from the path; not a number where a position is none (or out of all bounds).
void largest_deviation(const device::Ranges& whose, View<const Vec3> from, View<const Vec3> move, View<const Vec3> y, device::EnvValues out) {
  device::env_max(
      "contact.deviation", whose,
      [=] MORTISE_HD(Index i) {
        return !(y[i].squaredNorm() < 1e300) ? static_cast<double>(NAN) : from.n > 0 ? off_path(from[i], move[i], y[i]) : 0.0;
      },
      out);
}

// dy *= by, of the points of every environment.
void scale(View<Vec3> dy, const std::vector<Index>& point_env, const std::vector<double>& by) {
  for (std::size_t e = 0; e < by.size(); ++e) {
    if (by[e] == 1) continue;
    const double factor = by[e];
    const Index first = point_env[e];
    device::parallel_for("contact.shorten", point_env[e + 1] - first, [=] MORTISE_HD(Index i) { dy[first + i] *= factor; });
  }
}

void keep_path(const device::Ranges& whose, View<const Vec3> y, View<const Vec3> dy, View<Vec3> from, View<Vec3> way) {
  device::parallel_for("contact.keep_path", whose, [=] MORTISE_HD(Index i) {
    from[i] = y[i];
    way[i] = dy.n > 0 ? dy[i] : Vec3(Vec3::Zero());
  });
}

}  // namespace

Candidates::Candidates(geometry::Broadphase& broadphase, double reach, std::vector<Index> point_env)
    : broadphase_(broadphase), reach_(reach), point_env_(std::move(point_env)), held_(point_env_.size() - 1, 0) {}

double Candidates::radius() const { return reach_ * (1 + tuning::kMargin); }

// What the broad phase has found on the way.
void Candidates::hold(const device::Buffer<Vec3>& y, const device::Buffer<Vec3>* dy, const std::vector<std::uint8_t>& whose) {
  broadphase_.copy(whose, pairs_);
  if (y0_.size() != y.size()) y0_.resize(y.size()), dy_.resize(y.size());
  keep_path({point_env_, whose}, y.view(), dy ? dy->view() : View<const Vec3>{}, y0_.view(), dy_.view());
  for (std::size_t e = 0; e < held_.size(); ++e)
    if (whose.empty() || whose[e]) held_[e] = 1;
}

std::unique_ptr<geometry::Broadphase::Guess> Candidates::guess(const device::Buffer<Vec3>& y, const device::Buffer<Vec3>& dy,
                                                               const std::vector<std::uint8_t>& whose, device::Fetch& fetch) const {
  return broadphase_.guess(y.view(), dy.view(), radius(), whose, fetch);
}

bool Candidates::take(geometry::Broadphase::Guess& guess, const device::Buffer<Vec3>& y, const device::Buffer<Vec3>& dy,
                      const std::vector<std::uint8_t>& whose) {
  if (!broadphase_.take(guess)) return false;
  hold(y, &dy, whose);
  return true;
}

std::unique_ptr<geometry::Broadphase::Guess> Candidates::search(const device::Buffer<Vec3>& y, device::Buffer<Vec3>& dy,
                                                                const std::vector<std::uint8_t>& whose, const geometry::Broadphase::Guess& refused,
                                                                std::vector<double>& share, device::Fetch& fetch) {
  share.assign(held_.size(), 1.0);
  const auto shorten = [&](const std::vector<double>& by) {
    scale(dy.view(), point_env_, by);
    for (std::size_t e = 0; e < by.size(); ++e) share[e] *= by[e];
  };
  std::unique_ptr<geometry::Broadphase::Guess> out = broadphase_.search(y.view(), std::as_const(dy).view(), refused, shorten, fetch);
  if (!out) hold(y, &dy, whose);
  return out;
}

void Candidates::cover(const device::Buffer<Vec3>& y, std::vector<std::uint8_t>& finite, const std::vector<std::uint8_t>& whose) {
  device::Fetch fetch;
  Look here;
  look(y, whose, here, fetch);
  fetch.now("deviation from the path");
  settle(y, here, finite);
}

void Candidates::look(const device::Buffer<Vec3>& y, const std::vector<std::uint8_t>& whose, Look& to, device::Fetch& fetch) const {
  to.whose = whose;
  to.off.clear();
  for (std::uint8_t held : held_) to.off.push_back(held ? 0 : INFINITY);
  largest_deviation({point_env_, whose}, y0_.view(), dy_.view(), y.view(), {to.off, fetch});
}

bool Candidates::settle(const device::Buffer<Vec3>& y, const Look& look, std::vector<std::uint8_t>& finite) {
  const std::vector<double>& off = look.off;
  finite.assign(off.size(), 1);
  std::vector<std::uint8_t> lost(off.size(), 0);
  bool any = false;
  for (std::size_t e = 0; e < off.size(); ++e) {
    if (!look.whose.empty() && !look.whose[e]) continue;
    finite[e] = !std::isnan(off[e]);
    lost[e] = 2 * off[e] > tuning::kMargin * reach_;  // two points of a pair may each be off by half of the margin
    any = any || lost[e];
  }
  if (any) {
    broadphase_.update(y.view(), {}, radius(), lost);
    hold(y, nullptr, lost);
  }
  return any;
}

}  // namespace mortise::effects::contact
