#!/usr/bin/env python3
"""A prediction, never a measurement: time of a Newton iteration on an H200 from what the emulated device counted.

  predict.py BUILD [--result FILE]

Two checked runs of a scene that differ by one step give launches, host waits and bytes of that step. A launch is bounded below by the bytes
that it touches at least once over the bandwidth of the memory, and by the time between two launches; a wait costs a round trip. What
this leaves out makes it optimistic: latency and low occupancy inside kernels, caches that are too small, sorting's several passes over shared memory.
"""
import argparse
import json
import sys
from pathlib import Path

from campaign import ROOT, run

BANDWIDTH = 4.8e12  # [B/s] NVIDIA H200 data sheet
LAUNCH = 2.5e-6     # [s] from one kernel of a stream to the next; assumed
WAIT = 12e-6        # [s] a copy of a few numbers to the host, and the host's next launch; assumed
CG = ["solver.linear=cg", "solver.preconditioner=mas"]
PRESS = ["effects.pin.1.motion.time=[0, 0.01, 0.02, 0.03]", *CG]
# scene, values, steps before the one that is looked at, environments
CASES = {
    "press, whole mesh": ("scenes/tactile/press.yaml", PRESS, 1, 1),
    "pad of 280 nodes": ("benchmarks/gpu/pad.yaml", CG, 4, 1),
    "4,096 pads of 280 nodes": ("benchmarks/gpu/pad.yaml", CG, 4, 4096),
}


def counted(build, scene, values, steps):
    out, report = build / "ptx/out/predict", build / "ptx/out/predict.json"
    report.unlink(missing_ok=True)
    command = [build / "ptx/bin/mortise", "run", ROOT / scene, "--no-render", "-q", "--overwrite", "--device", "cuda", "-o", out, "--set", f"time.steps={steps}"]
    for v in values:
        command += ["--set", v]
    done, _ = run(command, report)
    if done.returncode != 0:
        sys.exit(done.stderr)
    r, j = json.loads(report.read_text().splitlines()[-1]), json.loads((out / "run.json").read_text())
    return r["kernels"], j["steps"]["newton_iterations"]["total"], j["transfers"]["steps"]["to_host"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--only", default="", help="cases with this in their names")
    parser.add_argument("--result", type=Path)
    a = parser.parse_args()
    rows, seen = [], {}
    for name, (scene, values, before, environments) in CASES.items():
        if a.only not in name:
            continue
        if scene not in seen:
            seen[scene] = [counted(a.build.resolve(), scene, values, n) for n in (before, before + 1)]
        (k0, n0, w0), (k1, n1, w1) = seen[scene]
        newton, launches, touched, accessed, kernels = n1 - n0, 0, 0, 0, []
        for kernel, (l, _, all_bytes, once) in k1.items():
            old = k0.get(kernel, [0, 0, 0, 0])
            launches, accessed, touched = launches + l - old[0], accessed + all_bytes - old[2], touched + once - old[3]
            kernels.append((once - old[3], l - old[0], kernel))
        row = {
            "case": name, "newton_iterations": newton, "launches": launches / newton, "waits": (w1 - w0) / newton,
            "megabytes_touched": environments * touched / newton / 1e6, "megabytes_accessed": environments * accessed / newton / 1e6,
        }  # fmt: skip
        row["launch_ms"], row["wait_ms"] = 1e3 * LAUNCH * row["launches"], 1e3 * WAIT * row["waits"]
        row["memory_ms"] = 1e3 * environments * touched / newton / BANDWIDTH
        row["predicted_ms"] = row["wait_ms"] + sum(1e3 * max(LAUNCH * l, environments * b / BANDWIDTH) for b, l, _ in kernels) / newton
        row["max_bytes"] = [{"kernel": k[:160], "megabytes": environments * b / newton / 1e6, "launches": l / newton} for b, l, k in sorted(kernels, reverse=True)[:8]]
        rows.append(row)
        print(f"{name:26} {launches / newton:6.0f} launches {row['waits']:5.1f} waits {row['megabytes_touched']:9.2f} MB: {row['predicted_ms']:.2f} ms per Newton iteration (predicted)")
    if a.result:
        a.result.write_text(json.dumps({"bandwidth": BANDWIDTH, "launch_s": LAUNCH, "wait_s": WAIT, "cases": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
