#!/usr/bin/env python3
"""Runs scenes, benchmarks and test programs on the emulated GPU in checked mode, forwards and backwards, beside the CPU.

  campaign.py BUILD [--short] [--only WORDS] [--go-on] [--jobs N] [--result FILE]

A campaign takes hours on two cores: --go-on leaves out what passed before with these sources, and counts it. Exit code 1 when something was reported, results differ, or (whole campaign) a kernel of the module never ran.
"""
import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent

DIRECT = "solver.linear=direct"  # as on a CPU: by itself a GPU takes conjugate gradients for environments
# name: (scene, or who writes it; values set, and options where they begin with --)
SCENES = {
    "first/01_free_fall": ("scenes/first/01_free_fall.yaml", []),
    "first/02_block_on_floor": ("scenes/first/02_block_on_floor.yaml", ["time.steps=50"]),
    "first/03_incline_friction": ("scenes/first/03_incline_friction.yaml", ["time.steps=30"]),
    "first/04_two_bodies": ("scenes/first/04_two_bodies.yaml", ["time.steps=12"]),
    "first/05_static_press": ("scenes/first/05_static_press.yaml", []),
    "first/06_quadratic_beam": ("scenes/first/06_quadratic_beam.yaml", []),
    "first/07_pendulum_with_pad": ("scenes/first/07_pendulum_with_pad.yaml", ["time.steps=4"]),
    "first/08_environments": ("scenes/first/08_environments.yaml", ["time.steps=4", "environments.count=3", DIRECT]),
    "first/09_driven_leg": ("scenes/first/09_driven_leg.yaml", ["time.steps=4"]),
    "first/10_gripper": ("scenes/first/10_gripper.yaml", ["time.steps=4"]),
    "static mortar": ("benchmarks/patch/scene.yaml", ["quantities=[{name: top, value: displacement, body: top, over: max, axis: z}]"]),
    "long ways": ("benchmarks/effectivity/peak.yaml", ["solver.linear=cg"]),  # Broadphase::search
    "tactile/press, 2 frames": ("scenes/tactile/press.yaml", ["time.steps=2"]),
    "tactile/taxels, 1 frame": ("scenes/tactile/taxels.yaml", ["time.steps=1", "time.frame_every=1"]),
}
ENVIRONMENTS = "environments={count: 3, seed: 1, vary: [{path: effects.friction.mu, abs: {uniform: [0.1, 0.9]}}]}"
GAINS = "environments={count: 3, seed: 1, vary: [{path: effects.drive.0.kp, abs: {uniform: [4, 6]}}]}"
TOGETHER = "--together=all"  # in one model; else each is a process of its own
VARIANTS = {
    "barrier": {
        "": [],
        "classic": ["effects.barrier_contact.form=classic"],
        "bdf2": ["effects.inertia.integrator=bdf2"],
        "linear material": ["materials.gel.model=linear"],
        "corotated": ["materials.gel.model=corotated"],
        "cg jacobi": ["solver.linear=cg", "solver.preconditioner=jacobi"],
        "cg mas": ["solver.linear=cg", "solver.preconditioner=mas"],
        "reuse": ["solver.linear=reuse"],
        "fixed forcing": ["solver.linear=cg", "solver.cg_forcing=fixed"],
        "quadratic": ["bodies.pad.order=2"],
        "environments": [ENVIRONMENTS],
        "environments cg mas": [ENVIRONMENTS, "solver.linear=cg", "solver.preconditioner=mas"],
        "together": [ENVIRONMENTS, TOGETHER],
        "together cg mas": [ENVIRONMENTS, TOGETHER, "solver.linear=cg", "solver.preconditioner=mas"],
    },
    "mortar": {
        "": [],
        "averaged": ["effects.mortar_contact.gap=averaged"],
        "exact gradient": ["effects.mortar_contact.gradient=exact"],
        "tapered": ["effects.mortar_contact.weights=tapered"],
        "two-pass": ["effects.mortar_contact.two_pass=true"],
        "exact quadrature": ["effects.mortar_contact.quadrature=exact"],
        "7 points": ["effects.mortar_contact.quadrature=7"],
        "quadratic": ["bodies.pad.order=2", "bodies.block.order=2"],
        "environments": [ENVIRONMENTS],
        "together": [ENVIRONMENTS, TOGETHER],
        "averaged together": ["effects.mortar_contact.gap=averaged", ENVIRONMENTS, TOGETHER],
        "rest share": ["effects.mortar_contact.rest_share=0.5"],
        "averaged, finer": ["effects.mortar_contact.gap=averaged", "bodies.block.shape.box.edge_length=1 mm", "bodies.pad.shape.box.edge_length=1.6 mm"],
    },
    "robot": {"": [], "bdf2": ["effects.inertia.integrator=bdf2"], "together": [GAINS, TOGETHER, DIRECT]},
    "loose": {
        "": [],
        "direct": ["solver.linear=direct"],
        "reuse": ["solver.linear=reuse"],
        "cg": ["solver.linear=cg"],
    },
}
for base, variants in VARIANTS.items():
    for variant, values in variants.items():
        SCENES[f"{base} {variant}".strip()] = (f"tests/ptx/scenes/{base}.yaml", values)
# Sums over more than one chunk of 64 terms: as many robots as that in one environment.
CROWD = 66


def crowd(folder):
    """Writes its scene: bars on hinges of the world, each with a motor, a spring and stops, and a second bar that mimics the first."""
    bodies, joints, drives = {}, [], []
    for i in range(CROWD):
        y = f"{40 * i} mm"
        bar = {"type": "stiff", "shape": {"box": {"size": ["80 mm", "10 mm", "10 mm"], "edge_length": "80 mm"}}, "material": "steel"}
        bodies[f"upper{i}"] = bar | {"position": ["40 mm", y, "0 mm"]}
        bodies[f"lower{i}"] = bar | {"position": ["120 mm", y, "0 mm"]}
        joints.append({"name": f"shoulder{i}", "body": f"upper{i}", "type": "revolute", "at": ["0 mm", y, "0 mm"], "axis": [0, 1, 0],
                       "angle_limits": ["-0.5 deg", "20 deg"]})
        joints.append({"name": f"elbow{i}", "body": f"lower{i}", "to": f"upper{i}", "type": "revolute", "at": ["80 mm", y, "0 mm"], "axis": [0, 1, 0],
                       "mimic": {"joint": f"shoulder{i}", "ratio": 2}})
        drives.append({"joint": f"shoulder{i}", "mode": "pd", "kp": 5, "kd": 0.05, "angle": "1 deg", "stiffness": 0.5})
    scene = {"mortise": 1, "name": "crowd", "time": {"step": "5 ms", "steps": 2}, "materials": {"steel": {"density": 7800}}, "bodies": bodies,
             "effects": {"inertia": {}, "gravity": {}, "affine_body": {}, "joint": joints, "drive": drives}}
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "scene.yaml"
    path.write_text(json.dumps(scene))
    return path


SCENES["crowd"] = (crowd, [])

BENCHMARKS = {"bench patch": ["patch"], "bench hertz": ["hertz", "--set", "size=coarse"]}
# Scenes that go beside a run.
STUDIES = {"error budget": ["tests/ptx/scenes/barrier.yaml", "--set", "time.steps=3", "--error-budget", "--qoi", "barrier_contact/energy", "--qoi", "inertia/kinetic_energy"]}
# What the runtime is made to answer (report.h), and what the program has to say then, with exit code 4.
ERRORS = {
    "cudaGetDeviceCount:1:35": "the NVIDIA driver is too old: it knows CUDA 13.0, this build needs 13.0; update the driver",
    "cudaGetDeviceCount:1:35,cudaDriverGetVersion:1:35": "no NVIDIA driver on this machine",
    "cudaGetDeviceCount:1:100": "no NVIDIA GPU on this machine",
    "cudaGetDeviceCount:1:999": "the NVIDIA driver reports: ",
    "cudaMallocAsync:200:2": r"out of device memory: \d+ MiB more asked for \(after '[a-z_.]+'\), \d+ MiB in use of 8192 MiB",
    "cudaMallocAsync:200:700": r"illegal memory access was encountered in allocate, by it or a kernel before it \(the last launch: '[a-z_.]+'",
    "cudaLaunchKernel:300:700": r"illegal memory access was encountered in [a-z_.]+, by it or a kernel before it",
    "cudaLaunchKernel:1:209": "no kernel image is available for execution on the device",
    "cudaMemcpy:30:719": r"in (up|down)load, by it or a kernel before it",
    "cudaGraphInstantiate:1:2": "out of memory in graph",
}
TWINS = ["device", "model", "linalg", "geometry", "effects"]
SHORT = ["barrier", "mortar", "mortar averaged", "barrier cg mas"]


def run(command, report=None, backwards=False, **environment):
    env = dict(os.environ, **environment)
    if report:
        env |= {"MORTISE_PTX_CHECK": "1", "MORTISE_PTX_REPORT": str(report)}
    if backwards:
        env |= {"MORTISE_PTX_ORDER": "backwards"}
    start = time.time()
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True, env=env)
    return done, time.time() - start


def datasets(path):
    """Every result in a file of fields; seconds are none."""
    out = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu" and not name.endswith("steps/wall_ms"):
            out[name] = item[()]

    with h5py.File(path) as f:
        f.visititems(keep)
    return out


def compare(a, b):
    """('bits', 0) or ('alike', largest difference of positions by the size of the scene)."""
    a, b = datasets(a), datasets(b)
    if a.keys() == b.keys() and all(np.array_equal(a[k], b[k], equal_nan=a[k].dtype.kind == "f") for k in a):
        return "bits", 0.0
    points = "VTKHDF/Points" if "VTKHDF/Points" in a else "environments/Points"
    x, y = a[points].reshape(-1, 3), b[points].reshape(-1, 3)
    if x.shape != y.shape:
        return "alike", float("inf")
    return "alike", float(np.abs(x - y).max() / np.ptp(x, axis=0).max())


def file_of(name):
    return name.replace("/", "_").replace(" ", "_").replace(",", "")


def sources():
    """A digest of everything that the programs are made of."""
    digest = hashlib.sha256()
    for folder in ("src", "tests"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp", ".cu", ".txt", ".c"):
                digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


class Campaign:
    def __init__(self, build, go_on):
        self.build, self.out = build, build / "ptx" / "out"
        self.bin = build / "ptx" / "bin"
        self.reports, self.passed = self.out / "reports", self.out / "passed"
        self.sources = sources()
        stale = not go_on or not (self.passed / self.sources).exists()
        for folder in (self.reports, self.passed):
            if stale:
                shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True, exist_ok=True)
        (self.passed / self.sources).touch()

    def before(self, name):
        """What an earlier call found of a job that passed; None where there is no such."""
        path = self.passed / (file_of(name) + ".json")
        return json.loads(path.read_text()) if path.exists() else None

    def report(self, name, order):
        return self.reports / file_of(name) / (order + ".json")

    def said(self, files="*/*"):
        return [json.loads(line) for path in sorted(self.reports.glob(files)) for line in path.read_text().splitlines()]

    def scene(self, name):
        path, values = SCENES[name]
        folder = self.out / file_of(name)
        path = path(self.out / "scenes") if callable(path) else ROOT / path
        common = [self.bin / "mortise", "run", path, "--overwrite", "--no-render", "-q", "--set", "output.precision=double"]
        for v in values:
            common += [v] if v.startswith("--") else ["--set", v]
        row = {"name": name}
        done, row["cpu_s"] = run([*common, "--device", "cpu", "-o", folder / "cpu"])
        if done.returncode != 0:
            return row | {"failed": "cpu: " + done.stderr.strip()}
        for order in ("forwards", "backwards"):
            done, row[f"{order}_s"] = run([*common, "--device", "cuda", "-o", folder / order], self.report(name, order), order == "backwards")
            if done.returncode != 0:
                return row | {"failed": f"{order}, exit code {done.returncode}: {done.stderr.strip()}"}
            if not any(n for r in self.said(f"{file_of(name)}/{order}*") for _, n, *_ in r["kernels"].values()):
                return row | {"failed": f"{order}: no kernel ran"}
        row["cpu"], row["difference"] = compare(folder / "cpu" / "fields.vtkhdf", folder / "forwards" / "fields.vtkhdf")
        row["orders"] = compare(folder / "forwards" / "fields.vtkhdf", folder / "backwards" / "fields.vtkhdf")[0]
        if row["orders"] != "bits":
            row["failed"] = "the order of the threads changes the result"
        if row["cpu"] != "bits":
            row["failed"] = f"positions differ from the CPU's by {row['difference']:.1e} of the scene"
        return row

    def resume(self, name):
        """Killed after a frame and resumed: the same bits as unbroken."""
        folder = self.out / "resume"
        command = [self.bin / "mortise", "run", HERE / "scenes/barrier.yaml", "--no-render", "-q", "--device", "cuda", "--set", "output.precision=double", "--set", "output.checkpoint_every.steps=1", "--set", "time.steps=4"]
        row = {"name": name}
        for end, more in (("whole", ["--overwrite"]), ("parts", ["--overwrite", "--frames", 2]), ("parts", ["--resume"])):
            done, row["forwards_s"] = run([*command, "-o", folder / end, *more], self.report(name, end + more[0]))
            if done.returncode != 0:
                return row | {"failed": done.stderr.strip()}
        row["cpu"] = "none"
        row["orders"] = compare(folder / "whole/fields.vtkhdf", folder / "parts/fields.vtkhdf")[0]
        return row if row["orders"] == "bits" else row | {"failed": "a resumed run has other bits"}

    def bench(self, name):
        rows, row = [], {"name": name}
        for device in ("cpu", "cuda"):
            done, row["cpu_s" if device == "cpu" else "forwards_s"] = run(
                [self.bin / "mortise", "bench", *BENCHMARKS[name], "--json", "--data", ROOT / "benchmarks" / BENCHMARKS[name][0], "--device", device],
                self.report(name, "forwards") if device == "cuda" else None)
            if done.returncode != 0:
                return row | {"failed": f"{device}, exit code {done.returncode}: {done.stderr.strip()}"}
            rows.append([json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")])
        pairs = [(a["value"], b["value"]) for a, b in zip(*rows) if isinstance(a.get("value"), float) and not a.get("quantity", "").endswith(("seconds", "of time"))]
        row["rows"], row["cpu"] = len(pairs), "alike"
        row["difference"] = max((abs(a - b) / max(abs(a), 1e-9) for a, b in pairs if np.isfinite(a)), default=float("inf"))
        return row if row["difference"] <= 1e-6 and len(rows[0]) == len(rows[1]) else row | {"failed": f"differs from the CPU by {row['difference']:.1e}"}

    def study(self, name):
        row, found = {"name": name, "cpu": "bits"}, []
        for order in ("cpu", "forwards", "backwards"):
            folder = self.out / file_of(name) / order
            command = [self.bin / "mortise", "study", ROOT / STUDIES[name][0], *STUDIES[name][1:], "--device", "cpu" if order == "cpu" else "cuda", "-o", folder]
            done, row[f"{order}_s"] = run(command, self.report(name, order) if order != "cpu" else None, order == "backwards")
            if done.returncode != 0:
                return row | {"failed": f"{order}, exit code {done.returncode}: {done.stderr.strip()}"}
            found.append(json.loads((folder / "error_budget.json").read_text())["quantities"])
        return row if found[0] == found[1] == found[2] else row | {"failed": "error budgets differ"}

    def bandwidth(self, name):
        row = {"name": name}
        done, row["forwards_s"] = run([self.bin / "mortise", "bench", "bandwidth", "--set", "edge=8", "--device", "cuda"], self.report(name, "forwards"))
        return row if done.returncode == 0 else row | {"failed": done.stderr.strip()}

    def errors(self, name):
        row = {"name": name, "tests": 0}
        for plan, words in ERRORS.items():
            command = [self.bin / "mortise", "run", HERE / "scenes/barrier.yaml", "--no-render", "-q", "--overwrite", "--device", "cuda", "-o", self.out / "errors", "--set", "solver.linear=cg"]
            done, row["forwards_s"] = run(command, MORTISE_PTX_FAIL=plan)
            if done.returncode != 4 or not re.search(words, done.stderr):
                return row | {"failed": f"{plan}: exit code {done.returncode}: {done.stderr.strip()}"}
            row["tests"] += 1
        return row

    def program(self, name):
        row = {"name": name}
        for order in ("forwards", "backwards"):
            command = {"test_ptx": [self.build / "bin/test_ptx"], "translator": [sys.executable, HERE / "translate_test.py", self.build]}.get(name, [self.bin / name])
            done, row[f"{order}_s"] = run(command, self.report(name, order) if name.endswith("_ptx") and name != "test_ptx" else None, order == "backwards", MORTISE_TEST_DEVICE="cuda", MORTISE_PTX_CHECK="1")
            row["tests"] = done.stdout.count("[       OK ]") or int((re.findall(r"Ran (\d+) tests", done.stderr) or [0])[0])
            if done.returncode != 0:
                failures = [line for line in done.stdout.splitlines() if line.startswith("[  FAILED  ]")]
                return row | {"failed": f"{order}, exit code {done.returncode}: {' '.join(failures[:5])} {done.stderr.strip()[-500:]}"}
        return row

    def job(self, name):
        if row := self.before(name):
            return row
        shutil.rmtree(self.reports / file_of(name), ignore_errors=True)
        (self.reports / file_of(name)).mkdir()
        kind = self.scene if name in SCENES else self.bench if name in BENCHMARKS else self.study if name in STUDIES else self.resume if name == "resume" else self.errors if name == "errors" else self.bandwidth if name == "bandwidth" else self.program
        try:
            row = kind(name)
        except Exception as e:  # a job that fails in an unforeseen way is a failed job
            row = {"name": name, "failed": f"{type(e).__name__}: {e}"}
        seconds = row.get("forwards_s", 0)
        print(f"{'FAIL' if 'failed' in row else 'ok  '} {name:28} {seconds:7.1f} s  {row.get('cpu', '')} {row.get('difference', '')} {row.get('failed', '')}", flush=True)
        if "failed" not in row:
            (self.passed / (file_of(name) + ".json")).write_text(json.dumps(row))
        return row

    def coverage(self):
        """Kernels of the module by how many threads of them ran; and what was reported."""
        threads, faults = {}, {}
        for r in self.said():
            for kernel, (_, n, *_) in r["kernels"].items():
                # Not the tests' own, nor what CUB asks for its architecture.
                if ("mortise::" in kernel or "cub::" in kernel) and not re.search("EmptyKernel|_INTERNAL_[0-9a-f]*_[0-9]*_[a-z_]*_test_cu_", kernel):
                    threads[kernel] = threads.get(kernel, 0) + n
            for fault, n in r["faults"].items():
                faults[fault] = faults.get(fault, 0) + n
        return threads, faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--only", default="", help="jobs with one of these words in their names, comma between them")
    parser.add_argument("--go-on", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--result", type=Path)
    a = parser.parse_args()
    campaign = Campaign(a.build.resolve(), a.go_on)
    names = ["translator", "test_ptx", "errors", *SHORT] if a.short else ["translator", "test_ptx", "errors", *[f"test_{t}_ptx" for t in TWINS], *BENCHMARKS, *STUDIES, "bandwidth", "resume", *SCENES]
    chosen = [n for n in names if any(word in n for word in a.only.split(","))]
    if a.go_on:
        chosen = [n for n in names if n in chosen or campaign.before(n)]
    complete = chosen == names and not a.short
    with ThreadPoolExecutor(a.jobs) as pool:
        rows = list(pool.map(campaign.job, chosen))
    threads, faults = campaign.coverage()
    never = sorted(k for k, n in threads.items() if n == 0)
    print(f"{len(threads) - len(never)} of {len(threads)} kernels ran, {sum(threads.values())} threads in all; {len(faults)} kinds of fault")
    if complete:
        for kernel in never:
            print("never ran:", kernel)
    if a.result:
        for row in rows:
            for key in list(row):
                if key.endswith("_s"):
                    row[key] = round(row[key], 1)
        a.result.write_text(json.dumps({"complete": complete, "kernels": len(threads), "ran": len(threads) - len(never), "threads": sum(threads.values()), "never": never, "faults": faults, "jobs": rows}, indent=1) + "\n")
    failed = any("failed" in r for r in rows) or bool(faults) or (bool(never) and complete)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
