#!/usr/bin/env python3
"""Writes trot.csv: joint angles of an open-loop trot of a quadruped with the legs of Unitree's Go2.

Every foot runs along a D in the plane of its leg, phase s in [0, 1), duty D, stride S, height H, clearance h, depth d:
  stance  u = s / D:            x = S (1/2 - u),                         z = -H - d sin(pi u)
  swing   u = (s - D)/(1 - D):  x = S (u - sin(2 pi u)/(2 pi) - 1/2),    z = -H + h (1 - cos(2 pi u))/2
Diagonal pairs are half a period apart; stride and clearance grow from standing. With thigh and calf of length L, r^2 = x^2 + z^2:
  calf = -acos((r^2 - 2 L^2) / (2 L^2)),   thigh = atan2(-x, -z) - calf / 2
"""
import argparse
import math
import pathlib

LINK = 0.213  # of thigh and calf [m]
LEGS = {"fl": 0.0, "fr": 0.5, "rl": 0.5, "rr": 0.0}  # phase


def angles(x, z):
    r2 = x * x + z * z
    calf = -math.acos((r2 - 2 * LINK * LINK) / (2 * LINK * LINK))
    return math.atan2(-x, -z) - calf / 2, calf


def foot(s, a, ramp):
    s %= 1
    stride, clearance, depth = a.stride * ramp, a.clearance * ramp, a.depth * ramp
    if s < a.duty:
        u = s / a.duty
        return stride * (0.5 - u), -a.height - depth * math.sin(math.pi * u)
    u = (s - a.duty) / (1 - a.duty)
    return stride * (u - math.sin(2 * math.pi * u) / (2 * math.pi) - 0.5), -a.height + clearance * (1 - math.cos(2 * math.pi * u)) / 2


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    number = lambda name, value, text: p.add_argument("--" + name, type=float, default=value, help=f"{text} (default {value})")
    number("frequency", 2.0, "gait cycles per second")
    number("duty", 0.55, "share of a cycle that a foot stands")
    number("stride", 0.10, "way of the foot on the ground in a stance [m]")
    number("clearance", 0.06, "of a swinging foot above the ground [m]")
    number("height", 0.27, "of the hips above the middle of the feet [m]")
    number("depth", 0.0, "how much further a standing foot reaches down in the middle of its stance [m]")
    number("stand", 0.3, "time before the first step [s]")
    number("ramp", 0.5, "time in which the steps grow [s]")
    number("time", 2.8, "in all [s]")
    number("step", 0.01, "of the table [s]")
    p.add_argument("-o", "--output", default=str(pathlib.Path(__file__).with_name("trot.csv")))
    a = p.parse_args()
    names = [f"{leg}_{joint} [rad]" for leg in LEGS for joint in ("thigh", "calf")]
    lines = ["time [s]," + ",".join(names)]
    for k in range(round(a.time / a.step) + 1):
        t = k * a.step
        walked = max(0.0, t - a.stand)
        u = min(1.0, walked / a.ramp)
        ramp = u * u * (3 - 2 * u)
        values = [v for phase in LEGS.values() for v in angles(*foot(walked * a.frequency + phase + a.duty / 2, a, ramp))]
        lines.append(f"{t:.6g}," + ",".join(f"{v:.6f}" for v in values))
    pathlib.Path(a.output).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
