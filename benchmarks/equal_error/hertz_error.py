"""Errors of a Hertz contact from the nodal forces on the block's face, by one rule for every program.

An exact solver would leave at node i the force f_i = int p(r) N_i dA with Hertz's pressure p at the run's own force and the node's hat function
N_i; its nodal pressure is f_i over the node's area. Against these, and not against p at the node, a coarse mesh has no error of reading.
Everything is taken at rest: both bodies are of one linear material, so points that meet were over each other at rest, and Hertz's theory knows no other
place. A quarter is modelled.
"""
import math

import calculix  # of ../peers

PARTS = 16  # a triangle under the contact is cut into PARTS^2 for the integral; its own error is below 1e-3 of the largest nodal force


def centres():
    """Centroids of PARTS^2 equal pieces of a triangle in barycentric coordinates."""
    n = 3 * PARTS
    for i in range(PARTS):
        for j in range(PARTS - i):
            u, v = (3 * i + 1) / n, (3 * j + 1) / n
            yield 1 - u - v, u, v
            if i + j < PARTS - 1:
                u, v = (3 * i + 2) / n, (3 * j + 2) / n
                yield 1 - u - v, u, v


CENTRES = list(centres())


class Face:
    """The block's upper face, z = 0 at rest: its nodes, their areas, its triangles."""

    def __init__(self, block, triangles):
        self.triangles = triangles
        self.nodes = sorted({n for t in triangles for n in t})
        self.at = {n: block["points"][n][:2] for n in self.nodes}
        self.area = dict.fromkeys(self.nodes, 0.0)
        for t in triangles:
            for n in t:
                self.area[n] += self.size(t) / 3

    def size(self, t):
        (ax, ay), (bx, by), (cx, cy) = (self.at[n] for n in t)
        return 0.5 * abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))

    def exact(self, force):
        """Nodal forces of Hertz's pressure at this force of the whole ball; their sum is made a quarter of it."""
        a, p0 = calculix.hertz(force)
        a, p0 = a / calculix.MM, p0 * 1e6  # m, Pa
        out = dict.fromkeys(self.nodes, 0.0)
        for t in self.triangles:
            p = [self.at[n] for n in t]
            longest = max(math.dist(p[i], p[i - 1]) for i in range(3))
            if min(math.hypot(*x) for x in p) > a + longest:
                continue
            weight = self.size(t) / len(CENTRES)
            for c in CENTRES:
                x, y = (sum(c[k] * p[k][d] for k in range(3)) for d in range(2))
                square = 1 - (x * x + y * y) / (a * a)
                if square > 0:
                    f = weight * p0 * math.sqrt(square)
                    for k in range(3):
                        out[t[k]] += f * c[k]
        scale = force / 4 / sum(out.values())
        return {n: f * scale for n, f in out.items()}

    def errors(self, force_at):
        """Relative errors of what a run says, from its nodal forces [N], with the force that the run says itself."""
        force = 4 * sum(force_at.values())
        exact = self.exact(force)
        wrong = sum((force_at[n] - exact[n]) ** 2 / self.area[n] for n in self.nodes)
        every = sum(exact[n] ** 2 / self.area[n] for n in self.nodes)
        peak = max(force_at[n] / self.area[n] for n in self.nodes) / max(exact[n] / self.area[n] for n in self.nodes)
        moment = sum(force_at[n] * math.hypot(*self.at[n]) ** 2 for n in self.nodes) / sum(exact[n] * math.hypot(*self.at[n]) ** 2 for n in self.nodes)
        return {"force_N": force, "pressure": math.sqrt(wrong / every), "peak": peak - 1, "radius": math.sqrt(moment) - 1}
