#!/usr/bin/env python3
"""Writes hand.csv, the robot's part of hand.yaml, and a striped ball to draw: a hand of 22 joints with the kinematics, masses and motors of a Sharpa Wave,
made of primitives a millimetre slimmer than its links, that grips a ball on the floor with its five soft tips, is lifted, and turns the ball in the hand.

The hand stands palm down: its frame has z along the fingers, x out of the palm, y to the thumb; the world's are z_hand, y_hand, -x_hand. Tips aim at
points of a horizontal circle about the ball's middle, at radius R + r - squeeze, and go round with the ball by `turn`. The angles of a finger that put
its tip p(q) there are those that minimise |p(q) - target|^2 + e^2 |q - q0|^2 (Gauss-Newton), q0 a posture of the hand.
"""
import argparse
import math
import pathlib
import struct
import zlib

BALL = 27.0  # radius [mm]
TIP = 7.5  # radius of the pads [mm]
GAP = 0.5  # of the ball above the floor at the start [mm]
STEP = 0.02  # of the table [s]
CELL = 0.45  # of links' meshes over their radius: round to the eye; links touch nothing
LIGHT, DARK = "[0.86, 0.87, 0.9]", "[0.3, 0.32, 0.36]"
E = 0.6  # [mm/rad]: how much posture counts

# Joint: place, axis at rest (palm frame, mm), limits [rad], effort [N m], speed [rad/s], kp [N m/rad]; body that it moves: mass [kg], radius, end of its capsule.
MCP = (-0.1745, 1.5708, 1.864, 16.1, 4.76)
AA = (-0.3491, 0.3491, 1.864, 16.1, 6.62)
Y, X = (0, 1, 0), (1, 0, 0)


def finger(name, x, y, z):
    at = lambda up: (x, y, z + up)
    return [(f"{name}_mcp_fe", at(0), Y, MCP, 0.0022, 6.0, None), (f"{name}_mcp_aa", at(0), X, AA, 0.0474, 8.0, at(47)),
            (f"{name}_pip", at(47), Y, (0, 1.7453, 0.638, 11.6, 0.9), 0.0182, 7.4, at(78.5)),
            (f"{name}_dip", at(78.5), Y, (0, 1.3963, 0.189, 14.7, 0.9), 0.0046, 4.0, at(96.5))]


T, A = (0.866, 0.354, -0.354), (0.5, -0.612, 0.612)
THUMB = [("thumb_cmc_fe", (10, 26, 21.4), (0, 0, -1), (-0.1745, 1.9199, 3.3, 11.8, 6.95), 0.0022, 8.0, None),
         ("thumb_cmc_aa", (5, 26, 21.4), X, (-0.3491, 0.3491, 3.3, 11.8, 13.2), 0.1359, 11.0, (15.4, 76.2, 63.1)),
         ("thumb_mcp_fe", (15.4, 76.2, 63.1), T, (-0.5236, 1.3963, 1.864, 16.1, 4.76), 0.0025, 6.0, None),
         ("thumb_mcp_aa", (15.4, 76.2, 63.1), A, (-0.3491, 0.3491, 1.864, 16.1, 6.62), 0.0308, 9.0, (15.4, 103.8, 90.7)),
         ("thumb_ip", (15.4, 103.8, 90.7), T, (0, 1.7453, 0.638, 11.6, 0.9), 0.0079, 4.0, (15.4, 117.9, 104.8))]
PINKY = [("pinky_cmc", (11.4, -26.3, 86.9), (0, 0, 1), (0, 0.2618, 0.5285, 35, 4.76), 0.1254, 6.0, (3, -31.1, 80.0))]
HAND = {"thumb": THUMB, "index": finger("index", 1, 30.3, 95.9), "middle": finger("middle", 0, 10, 98.9), "ring": finger("ring", 1.5, -10.3, 92.9),
        "pinky": PINKY + finger("pinky", 3, -31.1, 86.9)}
PLACES = {"thumb": 175, "index": 50, "middle": 14, "ring": -22, "pinky": -58}  # of the tips on the circle [deg], from the fingers' direction to the thumb
POSTURE = {"thumb": (1.2, 0, 0, 0, 0.3), "index": (0.5, 0, 0.8, 0.25), "middle": (0.5, 0, 0.8, 0.25), "ring": (0.5, 0, 0.8, 0.25), "pinky": (0.13, 0.5, 0, 0.8, 0.25)}

add = lambda a, b: tuple(x + y for x, y in zip(a, b))
sub = lambda a, b: tuple(x - y for x, y in zip(a, b))
times = lambda m, v: tuple(sum(r[k] * v[k] for k in range(3)) for r in m)
product = lambda a, b: tuple(tuple(sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)) for i in range(3))
ONE = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def turned(axis, angle):
    n = math.sqrt(sum(a * a for a in axis))
    x, y, z = (a / n for a in axis)
    c, s, d = math.cos(angle), math.sin(angle), 1 - math.cos(angle)
    return ((c + d * x * x, d * x * y - s * z, d * x * z + s * y), (d * x * y + s * z, c + d * y * y, d * y * z - s * x),
            (d * x * z - s * y, d * y * z + s * x, c + d * z * z))


def poses(chain, q):
    """Of every body x -> R x + t, from rest in the palm's frame."""
    R, t, out = ONE, (0, 0, 0), []
    for (_, place, axis, *_), angle in zip(chain, q):
        at = add(times(R, place), t)
        R = product(R, turned(axis, angle))
        t = sub(at, times(R, place))
        out.append((R, t))
    return out


def tip(chain, q):
    R, t = poses(chain, q)[-1]
    return add(times(R, chain[-1][6]), t)


def solve(a, b):
    n = len(b)
    m = [list(row) + [v] for row, v in zip(a, b)]
    for i in range(n):
        p = max(range(i, n), key=lambda k: abs(m[k][i]))
        m[i], m[p] = m[p], m[i]
        for k in range(n):
            if k != i:
                f = m[k][i] / m[i][i]
                m[k] = [x - f * y for x, y in zip(m[k], m[i])]
    return [m[i][n] / m[i][i] for i in range(n)]


def reach(chain, target, posture, q):
    q = list(q)
    for _ in range(60):
        here = tip(chain, q)
        miss = sub(target, here)
        columns = []
        for k in range(len(q)):
            moved = list(q)
            moved[k] += 1e-5
            columns.append([x / 1e-5 for x in sub(tip(chain, moved), here)])
        left = [[sum(x * y for x, y in zip(a, b)) + (E * E if i == j else 0) for j, b in enumerate(columns)] for i, a in enumerate(columns)]
        right = [sum(x * y for x, y in zip(a, miss)) + E * E * (p - v) for a, p, v in zip(columns, posture, q)]
        step = solve(left, right)
        most = max(0.1, max(abs(s) for s in step)) / 0.1
        before, q = q, [min(max(v + s / most, joint[3][0] + 0.02), joint[3][1] - 0.02) for v, s, joint in zip(q, step, chain)]
        if math.dist(before, q) < 1e-10:
            break
    return q, math.dist(target, tip(chain, q))


def world(v, height):
    return (v[2] / 1000, v[1] / 1000, (height - v[0]) / 1000)


def row(v):
    return "[" + ", ".join(f"{x:.7g}" for x in v) + "]"


def along(d):
    """The rotation that takes z to d, as the scene writes it."""
    n = math.sqrt(sum(x * x for x in d))
    axis = (-d[1], d[0], 0)
    if math.hypot(*axis) < 1e-9 * n:
        axis = (1, 0, 0)
    return f"{{axis: {row(axis)}, angle: {math.acos(max(-1, min(1, d[2] / n))):.7g}}}"


def scene(q, height, middle):
    """Bodies, joints, motors, bonds and sensors of hand.yaml, every one with its lines."""
    bodies, joints, drives, bonds, sensors = [], [], [], [], []
    centre = world(middle, height)
    for name, chain in HAND.items():
        at = poses(chain, q[name])
        before = "palm"
        for (joint, place, axis, (low, high, effort, speed, kp), mass, radius, end), (R, t), angle in zip(chain, at, q[name]):
            body, here = joint + "_link", world(add(times(R, place), t), height)
            there = world(add(times(R, end), t), height) if end else here
            shape = (f"capsule: {{radius: {radius:g} mm, height: {1000 * math.dist(here, there):.6g} mm, edge_length: {CELL * radius:.3g} mm}}" if end else
                     f"sphere: {{radius: {radius:g} mm, edge_length: {CELL * radius:.3g} mm}}")
            bodies.append(f"  {body}: {{type: stiff, shape: {{{shape}}}, mass: {mass:g}, position: {row(x / 2 for x in add(here, there))}"
                          + (f", rotation: {along(sub(there, here))}" if end else "") + f", visual: {{color: {DARK if end is None else LIGHT}}}}}")
            joints.append(f"    - {{name: {joint}, type: revolute, body: {body}, to: {before}, at: {row(here)}, axis: "
                          f"{row(sub(world(times(R, axis), 0), (0, 0, 0)))}, angle: {angle:.7g}, angle_limits: [{low}, {high}]}}")
            drives.append(f"    - {{joint: {joint}, mode: pd, kp: {kp}, kd: {0.05 * kp:.4g}, effort: {effort}, velocity: {speed}, "
                          f"file: {{path: hand.csv, column: {joint}}}}}")
            before = body
        pad = world(tip(chain, q[name]), height)
        bodies.append(f"  pad_{name}: {{type: soft, shape: {{sphere: {{radius: {TIP:g} mm, edge_length: 2.5 mm}}}}, material: rubber, position: {row(pad)}, "
                      f"self_contact: false, visual: {{color: [0.16, 0.17, 0.19]}}}}")
        bonds.append(f"    - {{body: pad_{name}, to: {before}, within: 0}}")
        normal = sub(centre, pad)
        face = add(pad, (TIP / 1000 * x / math.dist(centre, pad) for x in normal))
        sensors.append(f"  {name}: {{body: pad_{name}, position: {row(face)}, normal: {row(x / math.dist(centre, pad) for x in normal)}, up: [0, 0, 1], "
                       f"rows: 12, columns: 12, width: 12 mm, height: 12 mm}}")
    return {"bodies": bodies, "joint": joints, "drive": drives, "bond": bonds, "sensors": sensors}


def capsules(q, name):
    """Ends and radius of the links of a finger."""
    chain = HAND[name]
    return [(joint, add(times(R, place), t), add(times(R, end), t), radius)
            for (joint, place, _, _, _, radius, end), (R, t) in zip(chain, poses(chain, q[name])) if end]


def distance(p, a, b):
    d = sub(b, a)
    u = min(1, max(0, sum(x * y for x, y in zip(sub(p, a), d)) / sum(x * x for x in d)))
    return math.dist(p, add(a, (u * x for x in d)))


def clearances(q, middle, height):
    """Of links (the last ones of fingers, which the pads are on, apart) from the ball; from the floor; from those of the next finger [mm]."""
    links = {name: capsules(q, name) for name in HAND}
    ball = min(distance(middle, a, b) - BALL - r for some in links.values() for _, a, b, r in some[:-1])
    floor = min(height - max(a[0], b[0]) - r for some in links.values() for _, a, b, r in some)
    names = list(HAND)[1:]
    beside = min(distance(add(a, (k / 10 * x for x in sub(b, a))), c, d) - r - s for i, j in zip(names, names[1:])
                 for _, a, b, r in links[i] for _, c, d, s in links[j] for k in range(11))
    return ball, floor, beside


def write_ball(folder):
    """A sphere with texture coordinates, and eight stripes."""
    n, m, text = 32, 16, []
    for i in range(m + 1):
        for k in range(n + 1):
            a, b = math.pi * i / m, 2 * math.pi * k / n
            text.append(f"v {BALL / 1000 * math.sin(a) * math.cos(b):.6f} {BALL / 1000 * math.sin(a) * math.sin(b):.6f} {BALL / 1000 * math.cos(a):.6f}")
            text.append(f"vt {k / n:.6f} {1 - i / m:.6f}")
    for i in range(m):
        for k in range(n):
            a, b = i * (n + 1) + k + 1, (i + 1) * (n + 1) + k + 1
            if i < m - 1:
                text.append(f"f {a}/{a} {b}/{b} {b + 1}/{b + 1}")
            if i > 0:
                text.append(f"f {a}/{a} {b + 1}/{b + 1} {a + 1}/{a + 1}")
    (folder / "hand_ball.obj").write_text("\n".join(text) + "\n")
    row = b"\0" + b"".join(bytes((224, 78, 44) if k // 16 % 2 else (244, 238, 226)) for k in range(128))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    (folder / "hand_ball.png").write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", 128, 8, 8, 2, 0, 0, 0)) +
                                           chunk(b"IDAT", zlib.compress(row * 8)) + chunk(b"IEND", b""))


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    number = lambda name, value, text: p.add_argument("--" + name, type=float, default=value, help=f"{text} (default {value})")
    number("turn", 24, "of the tips about the ball [deg]; rolling on them it turns by (R + r) / R as much")
    number("squeeze", 2.5, "of ball and pad together, at every tip [mm]")
    number("open", 3, "distance of the tips from the ball at the start [mm]")
    a = p.parse_args()
    folder = pathlib.Path(__file__).parent
    ramp = lambda t, begin, end: (lambda u: u * u * (3 - 2 * u))(min(1.0, max(0.0, (t - begin) / (end - begin))))
    middle = (58.0, 3.0, 121.0)  # of the ball, in the palm's frame [mm]
    height = BALL + GAP + middle[0]  # of the palm's origin above the floor

    def target(name, t):
        r = BALL + TIP + a.open - (a.open + a.squeeze) * ramp(t, 0.0, 0.3)
        angle = math.radians(PLACES[name] + a.turn * (ramp(t, 0.7, 1.2) - 0.5))
        return add(middle, (0, r * math.sin(angle), r * math.cos(angle)))

    q, lines, worst, clear = dict(POSTURE), [], 0.0, (math.inf,) * 3
    lines.append("time [s]," + ",".join(f"{joint[0]} [rad]" for chain in HAND.values() for joint in chain))
    for k in range(round(1.4 / STEP) + 1):
        for name, chain in HAND.items():
            q[name], miss = reach(chain, target(name, k * STEP), POSTURE[name], q[name])
            worst = max(worst, miss)
        clear = tuple(map(min, clear, clearances(q, middle, height)))
        lines.append(f"{k * STEP:.6g}," + ",".join(f"{v:.6f}" for name in HAND for v in q[name]))
        if k == 0:
            parts = scene(q, height, middle)
    (folder / "hand.csv").write_text("\n".join(lines) + "\n")

    # Between the marks of hand.yaml stands what comes from here.
    text = (folder / "hand.yaml").read_text()
    for part, rows in parts.items():
        begin, end = f"# hand.py: {part}\n", f"# hand.py: end of {part}\n"
        head, rest = text.split(begin)
        indent = rest.split(end)[0].rsplit("\n", 1)[-1]
        text = head + begin + "\n".join(rows) + "\n" + indent + end + rest.split(end)[1]
    (folder / "hand.yaml").write_text(text)
    write_ball(folder)
    print(f"tips miss their circle by {worst:.2f} mm at most; links clear the ball by {clear[0]:.2f}, the floor by {clear[1]:.2f}, each other by "
          f"{clear[2]:.2f} mm\nthe ball stands at {row(world(middle, height))}")


if __name__ == "__main__":
    main()
