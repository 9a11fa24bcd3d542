#pragma once
// Closed-form answers, written independently of the code that they check.

namespace mortise::bench {

// Gap over d_hat at which the barrier carries the pressure p: the root t in (0, 1) of (1-t)(1/t - 1 - 2 ln t) = p/kappa.
double barrier_gap(double p_over_kappa);

// Hertz: sphere of radius R against a half-space (or R the effective radius), E* = 1/((1-nu1^2)/E1 + (1-nu2^2)/E2).
struct Hertz {
  double a;                         // contact radius [m], a = (3 F R/(4 E*))^(1/3)
  double p0;                        // largest pressure [Pa], p0 = 3F/(2 pi a^2)
  double pressure(double r) const;  // p0 sqrt(1 - r^2/a^2), 0 outside
};
Hertz hertz(double force, double radius, double e_star);

// Line contact: cylinder of radius R under the line load P [N/m] against a half-space, a = 2 sqrt(P R/(pi E*)), p0 = 2P/(pi a)
// (Johnson, Contact Mechanics, 1985, 4.2); r is the distance from the middle line.
Hertz hertz_line(double line_load, double radius, double e_star);

// Frictionless rigid punches on a half-space under the force F (Sneddon 1965; Johnson 3.4, 5.2).
// Flat, radius a: F = 2 a E* d, p = F/(2 pi a^2 sqrt(1 - r^2/a^2)).
double flat_punch_force(double a, double e_star, double depth);
double flat_punch_pressure(double force, double a, double r);
// Cone whose flank rises by `slope` per radius: a = (2/pi) d/slope, F = (2/pi) E* d^2/slope, p = E* slope/2 acosh(a/r).
double cone_force(double slope, double e_star, double depth);
double cone_radius(double slope, double e_star, double force);
double cone_pressure(double slope, double e_star, double a, double r);
// How deep the surface lies at r >= a, over the depth d in the middle: (2/pi) asin(a/r); cone: (2/pi) (asin(a/r) + sqrt(r^2/a^2 - 1) - r/a).
double flat_punch_surface(double a, double r);
double cone_surface(double a, double r);

// Pin in the bore of an infinite plate of the same material, plane, without friction, pushed by the force Q per thickness with the
// clearance D between the radii; modulus: E/(1 - nu^2) in plane strain. With b = tan(half-angle/2) and y = tan(angle/2)
//   modulus D/Q = (2 - 2 b^4 - ln(1 + b^2))/(pi b^2 (1 + b^2))
//   p R/Q = (2/pi) sqrt(b^2 - y^2)/((1 + y^2) sqrt(1 + b^2)) + ln[(sqrt(1 + b^2) + sqrt(b^2 - y^2))/(sqrt(1 + b^2) - sqrt(b^2 - y^2))]/(2 pi b^2 (1 +
//   b^2))
// (Persson 1964; Ciavarella, Decuzzi, Int. J. Solids Struct. 38, 2001, both for equal materials).
double pin_half_angle(double clearance_over_load);     // modulus D/Q > 0 -> half-angle of the contact [rad]
double pin_pressure(double half_angle, double angle);  // p R/Q
double pin_moment(double half_angle);                  // mean of sin^2(angle) over the contact, weighted with p; grows with the half-angle
double pin_half_angle_of_moment(double moment);

// Lame: a ring of radii a, b inside one of radii bore, c, of one material, pressed together by D: what they would overlap if they did
// not deform under p. p b/E [(c^2+bore^2)/(c^2-bore^2) + (b^2+a^2)/(b^2-a^2)] = D in plane stress, E/(1 - nu^2) for E in plane strain.
double pressed_rings_pressure(double a, double b, double bore, double c, double D, double modulus);

// Stiffness kappa at which a layer under pressure p is `k` times as stiff as a surface mesh of edge length h:
// kappa b''(g) h/E* = k at kappa phi(g/d_hat) = p (3 to 6 is best on Hertz: benchmarks/hertz/README.md).
double matched_stiffness(double p, double d_hat, double h, double e_star, double k);

}  // namespace mortise::bench
