#!/usr/bin/env python3
"""The figures that README.md states of a run of one of these scenes, from what the run wrote.

    mortise run scenes/robots/umi.yaml -o out/umi --no-render --set time.frame_every=1 --set output.precision=double
    figures.py out/umi

Needs h5py and numpy. Every scene: CPU seconds of the solver per simulated second, the share of every part, Newton iterations. Besides, by the name of the scene: grip, weights and creep of what is held (umi), force of
the feet over each cycle (quadruped), what the tips bear (hand). Forces of every step against the change of momentum are the judge's: `build/test/bin/mortise_judge out/umi/fields.vtkhdf`.
"""
import json
import sys

import h5py
import numpy as np


def cost(run, steps):
    seconds, phases = run["cpu_seconds"]["solve"], {}
    for p in run["phases"]:
        phases[p["effect"]] = phases.get(p["effect"], 0) + p["seconds"]
    simulated, whole = steps["time"][-1], sum(phases.values())
    n = steps["newton_iterations"][:]
    print(f"solver: {seconds:.0f} CPU s, {seconds / simulated:.0f} per simulated second; {len(n)} steps, {n.mean():.1f} Newton iterations, at most {n.max():.0f}; steps halved: {(steps['substeps'][:] > 1).sum()}")
    print("shares: " + ", ".join(f"{name} {100 * s / whole:.1f} %" for name, s in sorted(phases.items(), key=lambda x: -x[1])))


class Run:
    def __init__(self, file):
        self.effects, self.time = file["mortise/effects"], file["VTKHDF/Steps/Values"][:]
        n = int(file["VTKHDF/NumberOfPoints"][0])
        self.points = file["VTKHDF/Points"][:len(self.time) * n].reshape(len(self.time), n, 3)
        ids, self.body = file["VTKHDF/PointData/body_id"][:n], {}
        import yaml

        names = [b for b, what in yaml.safe_load(file["mortise/scene"][()])["bodies"].items() if what["type"] != "half_space"]
        for k, name in enumerate(names):
            self.body[name] = self.points[:, ids == k]

    def vector(self, stem):
        return np.stack([self.effects[stem + a][:] for a in "xyz"], axis=1)

    def within(self, a, b):
        return (self.time > a) & (self.time <= b)


def umi(r):
    """While nothing moves: both pads press alike, hang the cube, and it rests."""
    last = r.time[-1]
    still = r.within(1.0, 1.8) if last < 2 else r.within(0.2, 0.35)
    force = {p: (r.vector(f"barrier_contact/force_{p}_") + r.vector(f"friction/force_{p}_"))[still] for p in ("pad_left", "pad_right", "cube")}
    print("grip over", r.time[still][[0, -1]], "s: pads press with", *[f"{np.abs(force[p][:, 0]).mean():.6f} N" for p in ("pad_left", "pad_right")],
          f"(motor {r.effects['drive/left_force'][still].mean():g} N)")
    hold = force["cube"]
    print(f"cube: contact and friction bear {hold[:, 2].mean():.6f} N of its weight {0.05**3 * 800 * 9.81:.6f} N, sideways {np.abs(hold[:, :2]).max():.1e} N at most")
    if last < 2:
        low = (r.body["cube"] - r.body["palm"].mean(axis=1, keepdims=True)).mean(axis=1)[still]
        span = r.time[still][-1] - r.time[still][0]
        print(f"held in the air for {span:.2f} s the cube creeps {1e6 * np.linalg.norm(low[-1] - low[0]):.3f} um")


def quadruped(r):
    feet = sum(r.effects[f"barrier_contact/force_{f}_foot_z"][:] for f in ("fl", "fr", "rl", "rr"))
    for k in range(3):
        a = 1.3 + 0.5 * k
        print(f"feet bear {feet[r.within(a, a + 0.5)].mean():.2f} N on average from {a:.1f} to {a + 0.5:.1f} s (weight 157.7 N)")


def hand(r):
    ball = (r.vector("barrier_contact/force_ball_" if "barrier_contact" in r.effects else "mortar_contact/force_ball_") + r.vector("friction/force_ball_"))[r.within(1.3, 1.4)]
    print(f"the tips bear {ball[:, 2].mean():.5f} N of the ball's weight")


def main():
    folder = sys.argv[1]
    run = json.load(open(folder + "/run.json"))
    with h5py.File(folder + "/fields.vtkhdf") as file:
        cost(run, file["mortise/steps"])
        kind = run["scene"]["name"]
        if kind in ("umi", "quadruped", "hand"):
            {"umi": umi, "quadruped": quadruped, "hand": hand}[kind](Run(file))


main()
