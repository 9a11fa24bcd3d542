#!/usr/bin/env python3
"""Writes the meshes of scenes/hard that no primitive can make: tools/hard_meshes.py scenes/hard/meshes

Spikes, wedges, cracks, combs and the like, z up. All are grids of cells mapped into place, every cell cut into
six tetrahedra along the same diagonal, so that neighbours fit; cells may collapse (the tip of a spike is one node). Needs Python only.
"""
import math
import random
import sys
from itertools import permutations


class Mesh:
    """Points and tetrahedra; equal points are one."""

    def __init__(self):
        self.points, self.tets, self._id = [], [], {}

    def point(self, x):
        key = tuple(round(c, 12) + 0.0 for c in x)
        if key not in self._id:
            self._id[key] = len(self.points)
            self.points.append(key)
        return self._id[key]

    def grid(self, place, n, keep=lambda i, j, k: True, period=(0, 0, 0), mirror=False):
        """n = cells along three directions; place(u, v, w), each in 0..1, is the point; `period`: directions that close in a ring;
        `mirror`: the cuts of the two halves in every direction are mirror images."""
        def node(i, j, k):
            c = [a % n[d] if period[d] else a for d, a in enumerate((i, j, k))]
            return self.point(place(*(c[d] / n[d] for d in range(3))))
        for i in range(n[0]):
            for j in range(n[1]):
                for k in range(n[2]):
                    if not keep(i, j, k):
                        continue
                    low = [mirror and 2 * a < n[d] for d, a in enumerate((i, j, k))]  # then the diagonal runs downwards
                    for order in permutations(range(3)):
                        at = [a + low[d] for d, a in enumerate((i, j, k))]
                        ids = [node(*at)]
                        for d in order:
                            at[d] += -1 if low[d] else 1
                            ids.append(node(*at))
                        self.tet(ids)
        return self

    def tet(self, ids):
        """Adds a tetrahedron, turned so that its volume is positive; collapsed ones are left out."""
        if len(set(ids)) < 4:
            return
        a, b, c, d = (self.points[i] for i in ids)
        u, v, w = ([q - p for p, q in zip(a, x)] for x in (b, c, d))
        volume = sum(u[i] * (v[(i + 1) % 3] * w[(i + 2) % 3] - v[(i + 2) % 3] * w[(i + 1) % 3]) for i in range(3))
        if abs(volume) < 1e-18:
            return
        self.tets.append(ids if volume > 0 else [ids[0], ids[2], ids[1], ids[3]])

    def write(self, path):
        used = sorted({i for t in self.tets for i in t})
        new = {old: k + 1 for k, old in enumerate(used)}
        with open(path, "w") as f:
            f.write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%d\n" % len(used))
            for i in used:
                f.write("%d %s\n" % (new[i], " ".join("%.12g" % c for c in self.points[i])))
            f.write("$EndNodes\n$Elements\n%d\n" % len(self.tets))
            for k, t in enumerate(self.tets):
                f.write("%d 4 2 1 1 %s\n" % (k + 1, " ".join(str(new[i]) for i in t)))
            f.write("$EndElements\n")


def mix(a, b, t):
    return a + (b - a) * t


def disc(u, v):
    """Square 0..1 onto the unit disc, concentric squares onto circles."""
    x, y = 2 * u - 1, 2 * v - 1
    r = max(abs(x), abs(y))
    if r == 0:
        return 0.0, 0.0
    s = r / math.hypot(x, y)
    return x * s, y * s


def tet(*points):
    m = Mesh()
    m.tet([m.point(p) for p in points])
    return m


def block(lo, hi, n, keep=lambda i, j, k: True):
    return Mesh().grid(lambda u, v, w: tuple(mix(lo[d], hi[d], (u, v, w)[d]) for d in range(3)), n, keep)


def taper(half_x, half_y, ridge_y, height, n, m=None, at=(0, 0, 0)):
    """Base 2 half_x by 2 half_y at z = 0, narrowing to a ridge of half length ridge_y at x = 0 (0: to a tip)."""
    return (m or Mesh()).grid(lambda u, v, w: (at[0] + (2 * u - 1) * half_x * (1 - w), at[1] + (2 * v - 1) * mix(half_y, ridge_y, w),
                                               at[2] + height * w), n)


def crack(n=4):
    top = [0.5, 0.5, 0.0, 0.5, 0.5]
    return Mesh().grid(lambda u, v, w: (2 * u - 1, 4 * v - 2, mix(-0.5, top[round(4 * u)], w)), (4, 2 * n, 1))


def hole():
    return block((-1, -1, -0.5), (1, 1, 0.5), (4, 4, 2), lambda i, j, k: not (k == 1 and i in (1, 2) and j in (1, 2)))


def internal_edges():
    m = Mesh()
    top = {name: (x, y, 0.5) for name, x, y in (("A", -1, -1), ("B", 0, -1), ("C", 1, -1), ("D", 1, 0), ("E", 1, 1), ("F", 0, 1), ("G", -1, 1),
                                                  ("H", -1, 0), ("P", -0.5, 0.5), ("Q", 0.5, 0.5))}
    for a, b, c in "ABH BCD BDH HDQ HQP HPG PFG PQF QEF QDE".split():
        ids = [m.point(top[x]) for x in (a, b, c)] + [m.point(top[x][:2] + (-0.5,)) for x in (a, b, c)]
        order = sorted(range(3), key=lambda k: ids[k])  # the same diagonal from both sides of a face
        p, q, r = order
        m.tet([ids[p], ids[q], ids[r], ids[3 + r]])
        m.tet([ids[p], ids[q], ids[3 + q], ids[3 + r]])
        m.tet([ids[p], ids[3 + p], ids[3 + q], ids[3 + r]])
    return m


def torus(major, minor, around, across):
    def place(u, v, w):
        x, y = disc(v, w)
        r, a = major + minor * x, 2 * math.pi * u
        return r * math.cos(a), r * math.sin(a), minor * y
    return Mesh().grid(place, (around, across, across), period=(1, 0, 0))


def cone(radius, height, n, layers):
    """Tip at the origin, pointing down."""
    def place(u, v, w):
        x, y = disc(u, v)
        return radius * w * x, radius * w * y, height * w
    return Mesh().grid(place, (n, n, layers))


def sector(r0, r1, z, n):
    """Quarter of a ring, axis z."""
    return Mesh().grid(lambda u, v, w: (mix(r0, r1, u) * math.cos(math.pi / 2 * v), mix(r0, r1, u) * math.sin(math.pi / 2 * v), z * w), n)


def funnel(profile, wall, around):
    """Ring of revolution about z: inner radii at heights (z, r), outwards by `wall`."""
    def place(u, v, w):
        z, r = profile[round(w * (len(profile) - 1))]
        a = 2 * math.pi * u
        return (r + wall * v) * math.cos(a), (r + wall * v) * math.sin(a), z
    return Mesh().grid(place, (around, 1, len(profile) - 1), period=(1, 0, 0))


def bed(n, spacing, half, height):
    """n x n needles with tips at z = 0, pointing up; they do not hang together."""
    m = Mesh()
    for i in range(n):
        for j in range(n):
            taper(half, half, 0, height, (1, 1, 1), m, ((i - (n - 1) / 2) * spacing, (j - (n - 1) / 2) * spacing, -height))
    return m


def knives(n, spacing, half, length, height):
    m = Mesh()
    for i in range(n):
        taper(half, length / 2, length / 2, height, (1, 1, 1), m, ((i - (n - 1) / 2) * spacing, 0, -height))
    return m


def saw(teeth, pitch, depth, height, width):
    """Teeth upwards, tips at z = 0 and valleys at -depth; extruded along y."""
    return Mesh().grid(lambda u, v, w: ((u - 0.5) * teeth * pitch, (v - 0.5) * width, mix(-height, -depth if round(2 * teeth * u) % 2 == 0 else 0.0, w)),
                       (2 * teeth, 1, 1))


def slivers(size, thin, n):
    """A cube with one layer of cells of thickness `thin` in its middle."""
    z = [mix(0, size / 2, k / n) for k in range(n + 1)] + [size / 2 + thin] + [mix(size / 2 + thin, size, k / n) for k in range(1, n + 1)]
    return Mesh().grid(lambda u, v, w: ((u - 0.5) * size, (v - 0.5) * size, z[round(w * (len(z) - 1))]), (n, n, len(z) - 1))


def tessellated(size, thickness, n, jitter, seed):
    """Slab with its top at z = 0 whose inner nodes are moved at random along the plane."""
    rng = random.Random(seed)
    move = {}

    def place(u, v, w):
        i, j = round(u * n), round(v * n)
        if (i, j) not in move:
            inside = 0 < i < n and 0 < j < n
            move[i, j] = tuple(rng.uniform(-jitter, jitter) / n if inside else 0.0 for _ in range(2))
        return (u + move[i, j][0] - 0.5) * size, (v + move[i, j][1] - 0.5) * size, (w - 1) * thickness
    return Mesh().grid(place, (n, n, 1))


def arch(stones, span, crown, base, gap):
    """Stones of a catenary arch (rigid-ipc's proportions: sections 10 : 7, rise 60 : half span 30), scaled to `span`; one mesh per stone."""
    fc, half, qb, qt = 60.0, 30.0, 100.0, 49.0
    A = fc / (qb / qt - 1)
    C = math.acosh(qb / qt)
    scale = span / (2 * half)
    fine = 20000
    xs = [half * (2 * k / fine - 1) for k in range(fine + 1)]
    ys = [fc - A * (math.cosh(C * x / half) - 1) for x in xs]
    s = [0.0]
    for k in range(fine):
        s.append(s[-1] + math.hypot(xs[k + 1] - xs[k], ys[k + 1] - ys[k]))
    cuts, k = [], 0
    for i in range(stones + 1):
        while k < fine and s[k] < s[-1] * i / stones:
            k += 1
        x, y = xs[k], ys[k]
        slope = -A * C / half * math.sinh(C * x / half)
        nx, ny = -slope / math.hypot(1, slope), 1 / math.hypot(1, slope)
        if i in (0, stones):
            nx, ny = (-1.0 if i == 0 else 1.0), 0.0  # springings are level
        cuts.append((x * scale, y * scale, nx, ny, scale * mix(base, crown, y / fc) / 2))
    out = []
    for i in range(stones):
        m = Mesh()
        ends = (cuts[i], cuts[i + 1])
        tangent = [ends[1][d] - ends[0][d] for d in range(2)]
        length = math.hypot(*tangent)

        def place(u, v, w):
            x, y, nx, ny, t = ends[round(u)]
            away = (0.5 - u) * gap / length  # half of the gap at either end
            return x + nx * t * (2 * w - 1) + away * tangent[0], (2 * v - 1) * t, y + ny * t * (2 * w - 1) + away * tangent[1]
        m.grid(place, (1, 1, 1))
        out.append(m)
    return out


def fin_ball(radius, length, n, layers):
    """A ball with a spike on every second cell along either direction of its cube's faces: one grid, of which the cells of the ball and
    the columns over the chosen cells of its faces are kept. Spikes narrow to a quarter."""
    cells = n + 2 * layers

    def in_ball(q):
        """Cube -1..1 onto the unit ball, concentric cubes onto spheres."""
        r = max(map(abs, q))
        size = math.sqrt(sum(c * c for c in q))
        return tuple(c * r / size for c in q) if r else (0.0, 0.0, 0.0)

    def place(*w):
        at = [c * cells - layers for c in w]  # 0..n within the ball
        out = [max(0.0, -a) + max(0.0, a - n) for a in at]
        q = [2 * min(max(a, 0), n) / n - 1 for a in at]
        t = max(out) / layers
        if t == 0:
            return tuple(radius * c for c in in_ball(q))
        d = out.index(max(out))
        axis = list(q)
        for e in range(3):
            if e != d:
                axis[e] = 2 * (2 * math.floor(round(at[e]) / 2) + 0.5) / n - 1  # middle of the column, whose cell is an even one
        base, middle = in_ball(q), in_ball(axis)
        return tuple((radius + length * t) * m + radius * (b - m) * mix(1.0, 0.25, t) for b, m in zip(base, middle))

    def keep(i, j, k):
        at = [a - layers for a in (i, j, k)]
        inside = [0 <= a < n for a in at]
        if all(inside):
            return True
        return sum(inside) == 2 and all(a % 2 == 0 for a, b in zip(at, inside) if b)

    return Mesh().grid(place, (cells, cells, cells), keep)


def thread(inner, outer, pitch, turns, around, grow_in, grow_out):
    """A ring whose inner and outer radius (a function of the phase 0..1 of the thread) follow a helix. Turning it by two cells and lifting it
    by one layer gives the same mesh."""
    layers = turns * around // 2

    def place(u, v, w):
        a, z = 2 * math.pi * u, w * turns * pitch
        phase = (w * turns - u) % 1.0
        r = mix(inner + grow_in(phase), outer + grow_out(phase), v)
        return r * math.cos(a), r * math.sin(a), z
    return Mesh().grid(place, (around, 1, layers), period=(1, 0, 0))


def write_all(folder):
    def ridge(phase):
        """Height of the thread: a trapezium with a flat root and crest."""
        return min(1.0, max(0.0, 3 * (0.5 - abs(phase - 0.5)) - 0.25))
    meshes = {
        "tet_down": tet((0, 0.943, 1), (0, 0, 0), (1, -0.471, 1), (-1, -0.471, 1)),
        "tet_up": tet((0, 0.943, -1), (0, 0, 0), (1, -0.471, -1), (-1, -0.471, -1)),
        "tet_edges": tet((0, -1, 0), (0, 1, 0), (1, 0, -1), (-1, 0, -1)),
        "tet_corner": tet((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)),
        "tet_slot": tet((-0.5, -0.5, 0), (0.5, -0.5, 0), (0, 0.5, 0), (0, 0, 0.8)),
        "spike": taper(0.5, 0.5, 0, 3, (2, 2, 5)),
        "wedge": taper(0.5, 1, 1, 3, (2, 3, 5)),
        "crack": crack(),
        "hole": hole(),
        "cliff": Mesh().grid(lambda u, v, w: ((2 * u - 1) * mix(0.75, 0.5, w), (2 * v - 1) * mix(0.75, 0.5, w), w - 0.5), (2, 2, 2), mirror=True),
        "internal_edges": internal_edges(),
        "link": torus(0.405, 0.095, 20, 2),
        "cone": cone(0.5, 1, 4, 4),
        "fillet_part": sector(0.2, 0.999, 0.5, (3, 6, 2)),
        "fillet_seat": sector(1.0, 1.5, 0.5, (1, 6, 1)),
        "funnel": funnel([(1.0, 1.2), (0.0, 0.45), (-0.6, 0.45)], 0.3, 16),
        "bed": bed(7, 0.5, 0.1, 1),
        "knives": knives(5, 0.22, 0.02, 1.4, 0.5),
        "saw": saw(10, 0.1, 0.05, 0.2, 0.2),
        "cube": Mesh().grid(lambda u, v, w: (u - 0.5, v - 0.5, w - 0.5), (2, 2, 2), mirror=True),
        "slivers": slivers(1, 1e-4, 3),
        "tessellated": tessellated(2, 0.1, 12, 0.3, 1),
        "tray": block((-1, -1, 0), (1, 1, 0.9), (6, 6, 3), lambda i, j, k: k == 0 or i in (0, 5) or j in (0, 5)),
        "fin_ball": fin_ball(0.1, 0.05, 7, 1),
        "bolt": thread(3e-3, 8e-3, 10e-3, 4, 24, lambda p: 0, lambda p: 3e-3 * ridge(p)),
        "nut": thread(8.3e-3, 15e-3, 10e-3, 1, 24, lambda p: 3e-3 * ridge(p), lambda p: 0),
        "tunnel": block((-3, -0.75, -0.75), (3, 0.75, 0.75), (1, 3, 3), lambda i, j, k: not (j == 1 and k == 1)),
    }
    for i, stone in enumerate(arch(9, 6.0, 7.0, 10.0, 2e-4)):
        meshes["arch_%d" % i] = stone
    for name, mesh in meshes.items():
        mesh.write("%s/%s.msh" % (folder, name))
        print("%-16s %5d nodes %6d tets" % (name, len({i for t in mesh.tets for i in t}), len(mesh.tets)))


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    write_all(sys.argv[1])
