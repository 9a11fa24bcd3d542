#!/usr/bin/env python3
"""Writes README.md beside it: what the committed results say in one table, and what the parts of the press scene cost (cost.json)."""
import json
import os

HERE = os.path.dirname(os.path.abspath(__file__))
METHODS = ["gmcp_consistent", "gmcp_tapered", "ipc_area_weighted", "ipc_classic"]
# what, result, words in the case (empty: all), quantities
ROWS = [
    ("patch test, non-matching: stress / other stresses", "patch/result", ["non-matching", "top smaller", "slave top", "nu=0.45"], ["stress along the stack", "other stresses"]),
    ("the same, quadratic tetrahedra", "patch/result_quadratic", ["non-matching, quadratic", "top smaller, quadratic", "slave top, quadratic"], ["stress along the stack", "other stresses"]),
    ("interface tilted by 5 to 45 degrees: worst stress", "interface/result", ["tilt=5", "tilt=15", "tilt=30", "tilt=45"], ["stress (worst)"]),
    ("stack under gravity: force / gap", "tower/result", [], ["force", "mean gap"]),
    ("ring on ring: mean pressure / L2", "ring/result", [], ["mean pressure", "pressure L2"]),
    ("cylinder, a/8: pressure L2 / peak / half-width", "line/result", [], ["pressure L2, x <= a", "peak pressure", "half-width"]),
    ("Hertz, 1.3k vertices per body: L2 / peak / radius", "hertz/result", [], ["pressure L2, r <= a", "peak pressure", "contact radius"]),
    ("Hertz, 8k", "hertz/result_medium", [], ["pressure L2, r <= a", "peak pressure", "contact radius"]),
    ("Hertz, 21k", "hertz/result_fine", [], ["pressure L2, r <= a", "peak pressure", "contact radius"]),
    ("Hertz, quadratic, 20.3k nodes in all: L2 on r <= 0.9 a / peak", "hertz/result_quadratic", [], ["pressure L2, r <= 0.9 a", "peak pressure"]),
    ("sphere on sphere: L2 / peak", "spheres/result", ["approach R/500"], ["pressure L2, r <= a", "peak pressure"]),
    ("pin in a bore, quadratic: L2 / peak", "pin/result", [], ["pressure L2", "peak pressure"]),
    ("flat punch and cone, a/8: force", "indent/result", ["flat punch, h=a/8", "cone, 88 deg, h=a/8"], ["force at the depth"]),
    ("slide over a tessellated plane: drag / normal force", "slide/result", ["nu=0, slave block", "nu=0.3, slave block, exact"], ["drag / normal force"]),
]


def load(name):
    return json.load(open(os.path.join(HERE, name + ".json")))


def error(rows, method, cases, quantity):
    found = [r for r in rows if r["method"] == method and r["quantity"] == quantity and (not cases or r["case"] in cases)]
    if any(r["value"] is None for r in found):
        return "fails"
    errors = [r["error"] for r in found if r["error"] is not None]
    if not errors:
        return "-"
    e = max(errors)
    return "%.0e" % e if e < 1e-5 else "%.2g %%" % (100 * e)


def accuracy():
    out = ["| benchmark: error of | " + " | ".join(m.replace("_", " ") for m in METHODS) + " |", "|---" * (len(METHODS) + 1) + "|"]
    programs = set()
    for what, name, cases, quantities in ROWS:
        result = load(name)
        programs.add("%s, %s" % (result["program"], result["machine"]["cpu"]))
        cells = [" / ".join(error(result["rows"], m, cases, q) for q in quantities) for m in METHODS]
        out.append("| [%s](%s/README.md) | " % (what, name.split("/")[0]) + " | ".join(cells) + " |")
    return out + ["", "Worst of the cases; gmcp tapered is the published form, one stiffness and support radius for all methods. " + "; ".join(sorted(programs)) + "."]


def cost():
    c = load("cost")
    parts = sorted(c["parts"].items(), key=lambda p: -p[1])
    solve = sum(c["parts"].values())
    out = ["| part of the solve | seconds | share |", "|---|---|---|"]
    out += ["| %s | %.1f | %.1f %% |" % (name, s, 100 * s / solve) for name, s in parts]
    return out + ["", "`%s`, %s, %s threads of %s; %s; solve %.0f s, pictures %.0f s, files %.1f s, in all %.0f s (%.0f CPU s)." % (
        c["command"], c["program"], c["threads"], c["cpu"], c["load"], c["solve"], c["pictures"], c["files"], c["wall"], c["cpu_seconds"])]


TEXT = """# Benchmarks

Each folder has its physics, its reference and its committed results, with the program and the machine. `mortise bench --list` names them, `mortise bench hertz` runs one,
`benchmarks/run_all PROGRAM` all of them. This page is written by `summary.py` from the results.

%s

![Hertz: the pressure under the ball, four methods](hertz/pressure.svg)

## What accuracy costs

Error against CPU seconds, a curve per method or knob; six [studies](studies/README.md), two of them here:

![Hertz: error of the pressure against seconds](studies/hertz/work_precision.svg)
![Gel pad: errors of force and pressure against seconds](studies/gel/work_precision.svg)

Beside CalculiX on the same meshes: [peers](peers/README.md); seconds for the same error: [equal_error](equal_error/README.md). Growth of factors and conjugate gradients with size: [linear](linear/README.md). Hard cases and random scenes:
[hard](hard/README.md). What a GPU should measure: [gpu](gpu/README.md). Many environments: [environments](environments/README.md); a sweep that is killed: [sweep](sweep/README.md).
Whether grades of certificates rank true errors: [grades](grades/README.md); error budgets against true errors: [effectivity](effectivity/README.md); times that `check --plan` foretells: [plan](plan/README.md).

## What a scene's parts cost

Press scene: 11.2k nodes, 51k tetrahedra, friction 0.5.

%s
"""


def main():
    open(os.path.join(HERE, "README.md"), "w").write(TEXT % ("\n".join(accuracy()), "\n".join(cost()) if os.path.exists(os.path.join(HERE, "cost.json")) else "(not measured)"))


if __name__ == "__main__":
    main()
