#pragma once
// Contact holds surfaces apart by a gap where bodies of the real world touch. Between two bodies that both are held or driven, that gap is
// taken for indentation: with g the mean gap over the contact force and d how far the surfaces were pressed in, measured from the bodies'
// supports, or from where they are bonded to bodies that are supported, the force at the imposed travel is too large by about 3/2 g/d (Hertz: F ~
// d^1.5). Where loads balance the contact force, and not supports, no travel is imposed and the gap is no error of forces: g/d counts fully
// where supports of both bodies bear the contact force, less where they bear a part, and not where they bear less than half of it.
// Held are bodies with pins, and what joints, bonds and mortar ties hang on them or on the world (audit/holds.h). Motors with gains are springs in
// series with the contact: what they give under its force, e, is way that the layer is no part of, g / (d + e): g/d of a stiff motor, nothing of one
// that gives the same force everywhere. Bodies that are free, or hang on what gives way without a spring, and are pressed together between held ones
// take part in the travel as well. With all pairs p of contact in which such bodies are, their forces F, gaps g, and the work of contact on what is
// soft,
//
//     sum_p F_p g_p / (sum_i f_i . u_i + sum_p F_p (d + e)_p),       u_i: displacement without the body's rigid motion; d, e: of the held body of p
//
// which is g/d again where one body is pressed from two sides (both gaps, all of its shortening). It counts fully where forces of the held bodies
// balance each other, and not where their resultant, which a load bears, is more than half of one of two that press from opposite sides; of one body
// on a joint what counts are their parts along the joint's free coordinate, as of a lever. What one body holds from all sides, as a shaft a ring that
// is too tight, or a slot a block, is squeezed as far as forces of its own samples balance each other. Where nothing soft and no motor takes part in
// the travel, the layer is all that gives way, and decides the force: 1 where one of the bodies goes somewhere.
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "audit/holds.h"
#include "model/input.h"

namespace mortise::audit {

class LayerError {
 public:
  explicit LayerError(const model::ModelInput& input);
  // Samples of one contact effect: pairs of bodies, gaps [m], forces [N]; and, of pairs of bodies, what acts on the first: force [N], moment about
  // the world's origin [N m]. Without these of pairs, all that acts on a body counts.
  struct Samples {
    std::vector<double> bodies, gap, force;
    std::vector<double> pair_bodies{}, pair_force{}, pair_moment{};
  };
  // Of all points: displacement [m], support_force and tie_force [N] (empty: none), contact_force [N], contact_pressure [Pa].
  struct Fields {
    std::span<const double> displacement, support, tie, contact, pressure;
  };
  // A travel that supports impose on two held bodies, or on what held ones squeeze.
  struct Travel {
    std::vector<std::size_t> bodies;  // that press each other, by number
    double share;                     // of the force, that the travel decides
    double gap, deformed, way;        // what layer and soft bodies take of it, and all of it [m], or times forces [J]
    bool alone = false;               // nothing but the layer gives way
    double layer() const { return share * gap / way; }
    double stiffness() const { return share * deformed / way; }  // by how much the force is wrong, over how much the soft bodies' stiffness is
    static Travel of_layer(std::vector<std::size_t> bodies) { return {std::move(bodies), 1, 1, 0, 1, true}; }
  };
  // `number`: what was reported of joints and drives.
  std::vector<Travel> travels(const Samples& samples, const Fields& fields, const std::map<std::string, double>& number = {}) const;
  // Of the points where supports, bonds and ties bear a soft body, or that body which it is tied to, since rest; none where nothing holds it, or it
  // is stiff.
  std::optional<geometry::Motion> motion_of_supports(std::size_t body, const Fields& fields) const;
  geometry::Motion motion(std::size_t body, const Fields& fields) const;  // of all of its points, since rest
  // Largest share of g/d of any pair of supported bodies, or of what they press together; NaN where there is none. Where nothing but the layer gives
  // way it counts if wanted.
  static double worst(const std::vector<Travel>& travels, bool alone = true);

 private:
  struct Body {
    std::string name;
    std::size_t first, count;  // points
    bool soft;
  };
  // Farthest that loaded points of a held body are from where its supports are, and what motors give [m].
  struct Way {
    double pressed = 0, give = 0;
    bool imposed = true;  // by something
    bool free = false;    // nothing holds it against what presses
    double along = 0;     // on a joint: what presses along its free coordinate [N]
  };
  struct Pair {
    double force = 0, work = 0;  // over its samples: forces [N], times gaps [J]
    Vec3 on_first = Vec3::Zero(), moment = Vec3::Zero();
    bool known = false;  // the last two
    Way first, second;   // of its bodies
    double gap() const { return work / force; }
  };
  using Pairs = std::map<std::pair<std::size_t, std::size_t>, Pair>;

  Way way(std::size_t body, std::pair<std::size_t, std::size_t> pair, const Pair& of, const Fields& f,
          const std::map<std::string, double>& number) const;
  double indentation(std::size_t body, const Fields& fields) const;
  // Share of the contact force on a held body that its supports bear: of a stiff one, which has nothing free, all.
  double borne(std::size_t body, const Fields& fields) const;
  // Does the contact of a body, and nothing that holds it, balance itself?
  bool balances(std::size_t body, const Fields& fields) const;
  void squeezed(const Pairs& pairs, const Fields& f, std::vector<Travel>& out) const;
  bool goes(std::size_t body, const Pair& pair, const Fields& fields) const;  // by more than the gap, since rest
  double deformation_work(std::size_t body, const Fields& fields) const;

  Holds holds_;
  std::vector<Body> bodies_;
  std::vector<Vec3> rest_;  // of all points
  std::map<std::string, std::size_t> number_;
};

}  // namespace mortise::audit
