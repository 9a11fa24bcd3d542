#!/usr/bin/env python3
"""Makes the model of scenes/tactile: the shell of a sea urchin, about 16 mm across, as OBJ + MTL + PNG.

    tools/make_assets.py [FOLDER]        (default: scenes/tactile/assets; needs numpy)

Everything is computed here, so the files carry the licence of the project. The surface is a flattened ball, star-shaped about
the origin, with rows of knobs and a five-leaved rosette below; it is closed, and positions are shared across texture seams.
Lengths in metres, z up.
"""
import sys
import zlib
import struct
from pathlib import Path

import numpy as np

FREQUENCY = 27  # subdivisions of an icosahedron edge: 20 FREQUENCY^2 triangles
RADIUS, TOP, BOTTOM = 7.4e-3, 5.2e-3, 4.6e-3  # half axes of the ball [m]
COLUMNS = 10
SIZE = 1024  # texture


def base(d):
    """Point of the smooth ball in direction d (unit vectors, n x 3)."""
    z = np.where(d[:, 2] > 0, TOP, BOTTOM) * d[:, 2]
    # Five shallow lobes, as urchins have them.
    lobes = 1 + 0.018 * np.cos(5 * np.arctan2(d[:, 1], d[:, 0])) * (1 - d[:, 2] ** 2)
    return np.column_stack([RADIUS * lobes * d[:, 0], RADIUS * lobes * d[:, 1], z])


def direction(longitude, polar):
    s = np.sin(polar)
    return np.column_stack([s * np.cos(longitude), s * np.sin(longitude), np.cos(polar)])


def knobs():
    """Centres, radii and columns of the knobs: rows along meridians, every other column shifted by half a step."""
    fine = np.linspace(0, np.pi, 4001)
    p = base(direction(np.zeros_like(fine), fine))
    rho = np.hypot(p[:, 0], p[:, 1])
    arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    found = []
    for column in range(COLUMNS):
        wide = column % 2 == 0
        s = arc[-1] - 2.35e-3 - (0 if wide else 0.62e-3)  # from below
        while True:
            polar = np.interp(s, arc, fine)
            spacing = 2 * np.pi * np.interp(s, arc, rho) / COLUMNS
            if s < 2.2e-3:
                break
            radius = (0.40 if wide else 0.30) * min(spacing, 2.6e-3)
            found.append((2 * np.pi * column / COLUMNS, polar, radius, wide))
            s -= 2.15 * radius + (0.10e-3 if wide else 0.34e-3)
    a = np.array(found)
    return base(direction(a[:, 0], a[:, 1])), a[:, 2], a[:, 3]


def relief(d, p, centres, radii):
    """Height [m] of knobs and rosette above the ball; also the share 0..1 of knob and of rosette at each point."""
    knob, height = np.zeros(len(p)), np.zeros(len(p))
    for c, r in zip(centres, radii):
        near = np.abs(p[:, 2] - c[2]) < r
        q = np.sum((p[near] - c) ** 2, axis=1) / r**2
        bump = np.where(q < 1, (1 - q) ** 2 * (1 + 0.6 * q), 0)
        height[near] = np.maximum(height[near], 0.42 * r * bump)
        knob[near] = np.maximum(knob[near], np.where(q < 1, 1 - q, 0))
    rho, angle = np.hypot(p[:, 0], p[:, 1]), np.arctan2(p[:, 1], p[:, 0])
    # Rosette under the shell: five rounded leaves with a groove between them and a hollow in the middle.
    leaf = 0.5 + 0.5 * np.cos(5 * (angle - np.pi / 5))
    edge = 0.95e-3 + 0.85e-3 * leaf
    rosette = np.clip(1 - (rho / edge) ** 4, 0, 1) * np.clip((rho / 0.45e-3) ** 2, 0, 1) * (0.35 + 0.65 * leaf)
    rosette = np.where(d[:, 2] < 0, rosette, 0)
    # A ring of the same kind, small, on top.
    ring = np.where(d[:, 2] > 0, np.exp(-(((rho - 1.15e-3) / 0.35e-3) ** 2)) * (0.55 + 0.45 * np.cos(5 * angle)), 0)
    return height + 0.26e-3 * rosette + 0.22e-3 * ring, knob, rosette + ring


def icosphere(n):
    """Unit vectors and triangles (outward) of an icosahedron with n^2 triangles per face; a vertex at either pole."""
    h = 1 / np.sqrt(5)
    turn = 2 * np.pi * np.arange(5) / 5
    ring = 2 / np.sqrt(5)
    corners = [[0, 0, 1]] + [[ring * np.cos(t), ring * np.sin(t), h] for t in turn]
    corners += [[ring * np.cos(t + np.pi / 5), ring * np.sin(t + np.pi / 5), -h] for t in turn] + [[0, 0, -1]]
    corners = np.array(corners)
    faces = []
    for k in range(5):
        j = (k + 1) % 5
        faces += [(0, 1 + k, 1 + j), (1 + k, 6 + k, 1 + j), (1 + j, 6 + k, 6 + j), (11, 6 + j, 6 + k)]
    ids, points, triangles = {}, [], []

    def vertex(face, i, j):
        weights = {}
        for corner, w in zip(face, (n - i - j, i, j)):
            if w:
                weights[corner] = w
        key = tuple(sorted(weights.items()))
        if key not in ids:
            ids[key] = len(points)
            v = sum(w * corners[c] for c, w in key)
            points.append(v / np.linalg.norm(v))
        return ids[key]

    for face in faces:
        for i in range(n):
            for j in range(n - i):
                triangles.append((vertex(face, i, j), vertex(face, i + 1, j), vertex(face, i, j + 1)))
                if i + j < n - 1:
                    triangles.append((vertex(face, i + 1, j), vertex(face, i + 1, j + 1), vertex(face, i, j + 1)))
    return np.array(points), np.array(triangles)


def check(points, triangles):
    """Closed, manifold, outward, and star-shaped about the origin, hence without self-intersection."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert len(np.unique(edges, axis=0)) == len(edges), "an edge is used twice in the same direction"
    forward = set(map(tuple, edges))
    assert all((b, a) in forward for a, b in forward), "the surface has a hole"
    a, b, c = (points[triangles[:, k]] for k in range(3))
    assert np.all(np.einsum("ij,ij->i", a, np.cross(b, c)) > 0), "the surface is not star-shaped"
    assert len(points) - len(edges) // 2 + len(triangles) == 2, "the surface is not a ball"


def texture_corners(d, triangles):
    """Texture coordinates per corner: longitude and polar angle. Triangles across the seam run past 1, poles take the mean."""
    u = np.arctan2(d[:, 1], d[:, 0]) / (2 * np.pi) % 1.0
    v = 1 - np.arccos(np.clip(d[:, 2], -1, 1)) / np.pi
    cu = u[triangles]
    pole = np.abs(d[triangles][:, :, 2]) > 1 - 1e-12
    spread = np.where(pole, np.nan, cu)
    wraps = np.nanmax(spread, axis=1) - np.nanmin(spread, axis=1) > 0.5
    cu = np.where(wraps[:, None] & (cu < 0.5), cu + 1, cu)
    mean = np.nansum(np.where(pole, 0, cu), axis=1) / 2
    return np.where(pole, mean[:, None], cu), v[triangles]


def write_obj(folder, points, normals, triangles, u, v):
    corner = np.round(np.column_stack([u.ravel(), v.ravel()]), 6)
    unique, index = np.unique(corner, axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    with open(folder / "urchin.obj", "w") as f:
        f.write("# Shell of a sea urchin, metres, z up. Made by tools/make_assets.py.\nmtllib urchin.mtl\no urchin\n")
        for p in points:
            f.write("v %.8f %.8f %.8f\n" % tuple(p))
        for t in unique:
            f.write("vt %.6f %.6f\n" % tuple(t))
        for n in normals:
            f.write("vn %.4f %.4f %.4f\n" % tuple(n))
        f.write("usemtl shell\ns 1\n")
        for t, k in zip(triangles + 1, index + 1):
            f.write("f %d/%d/%d %d/%d/%d %d/%d/%d\n" % (t[0], k[0], t[0], t[1], k[1], t[1], t[2], k[2], t[2]))
    (folder / "urchin.mtl").write_text("newmtl shell\nKd 1 1 1\nPr 0.42\nPm 0\nmap_Kd urchin.png\n")


def mix(a, b, t):
    return a + (b - a) * t[:, None]


def smooth(lo, hi, x):
    t = np.clip((x - lo) / (hi - lo), 0, 1)
    return t * t * (3 - 2 * t)


def paint(centres, radii, wide):
    """Colours of the shell, as sRGB in 0..1, first row at the top pole."""
    u, t = np.meshgrid((np.arange(SIZE) + 0.5) / SIZE, (np.arange(SIZE) + 0.5) / SIZE)
    longitude, polar = 2 * np.pi * u.ravel(), np.pi * t.ravel()
    d = direction(longitude, polar)
    p = base(d)
    rho = np.hypot(p[:, 0], p[:, 1])
    rose, lilac, plum = np.array([0.80, 0.36, 0.42]), np.array([0.62, 0.42, 0.66]), np.array([0.36, 0.16, 0.38])
    cream, sage = np.array([0.97, 0.90, 0.80]), np.array([0.52, 0.62, 0.46])

    height = p[:, 2] / (TOP + BOTTOM) + 0.45
    colour = mix(np.tile(rose, (len(p), 1)), lilac, smooth(0.25, 0.95, height))
    # Slow mottling from a few waves over the sphere.
    mottle = np.zeros(len(p))
    for k, (ax, ay, az) in enumerate([(5, 3, 4), (9, -7, 6), (-13, 11, 8), (17, 15, -19)]):
        mottle += np.sin(1000 * (0.09 * ax * p[:, 0] + 0.09 * ay * p[:, 1] + 0.09 * az * p[:, 2]) * 2 + 1.7 * k) / (k + 2)
    colour *= (1 + 0.05 * mottle)[:, None]

    # Bands under the narrow columns, with their double rows of pores.
    phase = (longitude * COLUMNS / (2 * np.pi) - 1) % 2
    off = np.minimum(phase, 2 - phase) * 2 * np.pi * rho / COLUMNS  # distance from the middle of the band [m]
    half = np.clip(0.24 * 2 * np.pi * rho / COLUMNS, 0, 1.0e-3)
    band = 1 - smooth(0.85, 1.15, off / np.maximum(half, 1e-6))
    colour = mix(colour, sage, 0.75 * band)
    rim = np.exp(-(((off - half) / 0.10e-3) ** 2)) * smooth(1.2e-3, 2.4e-3, rho)
    colour = mix(colour, plum, 0.75 * rim)
    rows = np.sin(2 * np.pi * polar * 26)
    pores = np.exp(-(((off - 1.28 * half) / 0.075e-3) ** 2)) * smooth(0.25, 0.75, rows) * smooth(2.0e-3, 3.2e-3, rho)
    colour = mix(colour, 0.7 * plum, 0.85 * pores)

    # Knobs: a plum ring, a cream cap.
    for c, r, w in zip(centres, radii, wide):
        near = np.abs(p[:, 2] - c[2]) < 1.4 * r
        q = np.sqrt(np.sum((p[near] - c) ** 2, axis=1)) / r
        ring = np.exp(-(((q - 1.0) / 0.16) ** 2))
        cap = 1 - smooth(0.62 if w else 0.70, 0.80 if w else 0.92, q)
        part = mix(colour[near], plum, 0.75 * ring)
        colour[near] = mix(part, cream, 0.94 * cap)
    _, _, rosette = relief(d, p, centres[:0], radii[:0])
    colour = mix(colour, cream, 0.9 * smooth(0.15, 0.55, rosette))
    colour = mix(colour, plum, 0.6 * np.exp(-((rho / 0.55e-3) ** 2)))
    return np.clip(colour, 0, 1).reshape(SIZE, SIZE, 3)


def write_png(path, image):
    """8-bit RGB with the filters 1 (left) and 2 (up), whichever leaves the smaller residuals in a row."""
    pixels = np.round(255 * image).astype(np.int16)
    left = np.concatenate([pixels[:, :1], np.diff(pixels, axis=1)], axis=1)
    up = np.concatenate([pixels[:1], np.diff(pixels, axis=0)], axis=0)
    rows = []
    for a, b in zip(left, up):
        cost = [np.abs(np.where(x > 127, x - 256, np.where(x < -128, x + 256, x))).sum() for x in (a, b)]
        kind = int(np.argmin(cost))
        rows.append(bytes([kind + 1]) + ((a, b)[kind] % 256).astype(np.uint8).tobytes())

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0")
                     + chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) + chunk(b"IEND", b""))


def main():
    default = Path(__file__).resolve().parent.parent / "scenes" / "tactile" / "assets"
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    folder.mkdir(parents=True, exist_ok=True)
    centres, radii, wide = knobs()
    d, triangles = icosphere(FREQUENCY)

    def surface(d):
        p = base(d)
        height, _, _ = relief(d, p, centres, radii)
        length = np.linalg.norm(p, axis=1)
        return p * (1 + height / length)[:, None]

    points = np.round(surface(d), 8)
    check(points, triangles)
    # Normals of the exact surface, from central differences along two directions on the sphere.
    helper = np.where(np.abs(d[:, 2:3]) < 0.8, [[0.0, 0, 1]], [[1.0, 0, 0]])
    e1 = np.cross(helper, d)
    e1 /= np.linalg.norm(e1, axis=1)[:, None]
    e2 = np.cross(d, e1)

    def moved(e, h):
        q = d + h * e
        return surface(q / np.linalg.norm(q, axis=1)[:, None])

    h = 4e-3  # [rad], about a tenth of a mesh edge
    normals = np.cross(moved(e1, h) - moved(e1, -h), moved(e2, h) - moved(e2, -h))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    u, v = texture_corners(d, triangles)
    write_obj(folder, points, normals, triangles, u, v)
    write_png(folder / "urchin.png", paint(centres, radii, wide))
    size = points.max(axis=0) - points.min(axis=0)
    print(f"{len(points)} points, {len(triangles)} triangles, {len(centres)} knobs, "
          f"{1e3 * size[0]:.2f} x {1e3 * size[1]:.2f} x {1e3 * size[2]:.2f} mm, lowest z {1e3 * points[:, 2].min():.3f} mm")


if __name__ == "__main__":
    main()
