#!/usr/bin/env python3
"""Writes README.md beside it from result.json (`mortise bench hard --result`), fuzz.json (`mortise bench fuzz --result`), fuzz_wild.json (the same with --wild) and notes.md."""
import json
import os
import re
from collections import defaultdict

HERE = os.path.dirname(os.path.abspath(__file__))


def load(name):
    path = os.path.join(HERE, name)
    return json.load(open(path)) if os.path.exists(path) else None


def number(v):
    return "-" if v is None else "%.3g" % v


def short(reason):
    reason = re.sub(r"exit code 5: step (\d+) \(.*?\) failed: ", r"stops at step \1: ", reason.replace("|", "/"))
    return reason.split(" with a force residual")[0]


def verdict(r):
    if r["verdict"] == "fails":
        return "**fails**: " + short(r["reason"])
    return "reported: " + short(r["reported"]) if r["verdict"] == "reported" else "pass"


def count(rows, what):
    return sum(r["verdict"] == what for r in rows)


def hard(j):
    rows = j["rows"]
    part = lambda m: [r for r in rows if r["method"] == m]
    share = lambda x: "%d of %d pass, %d reported, %d fail" % (count(x, "pass"), len(x), count(x, "reported"), count(x, "fails"))
    base = defaultdict(list)
    for r in rows:
        if not r["variant"]:
            base[r["case"]].append(r)
    out = ["# Hard cases: results", "",
           "`mortise bench hard --threads 1 --result benchmarks/hard/result.json`, %s, %s; seconds are CPU time." % (j["machine"]["cpu"], j["program"]),
           "Scenes and criteria: `scenes/hard`. Every run is judged by its scene's `checks` and, independently, by `mortise_judge`. This file is written by `table.py`.", "",
           "**%s** (barrier_contact: %s; mortar_contact: %s). Of the %d scenes %d pass with every contact method they are run with. %.0f s in all." % (
               share(rows), share(part("barrier")), share(part("mortar")), len(base), sum(all(r["verdict"] != "fails" for r in v) for v in base.values()), sum(r["seconds"] for r in rows)),
           "Saved states of %d runs were judged (the others were refused before a state was solved, as they should be, or killed). Intersections: %d. Values that are not finite: %d. Crashes and steps that only "
           "seem to converge: %d." % (sum(r["judged"] for r in rows), sum(r["intersections"] for r in rows), sum(r["not_finite"] for r in rows),
                                      sum(bool(r["unsafe"]) and not r["intersections"] and not r["not_finite"] for r in rows)), "",
           "| case | contact | variant | steps | Newton max / mean | distance [m] | det F | energy gain | seconds | verdict |", "|---|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        out.append("| %s | %s | %s | %d | %d / %s | %s | %s | %s | %.1f | %s |" % (
            r["case"], r["method"], r["variant"], r["steps"], r["newton_max"], number(r["newton_mean"]), number(r["min_distance"]), number(r["min_det_f"]), number(r["energy_gain"]),
            r["seconds"], verdict(r)))
    return out


def fuzz(j, title, command):
    rows = j["rows"]
    kinds = defaultdict(list)
    for r in rows:
        if r["verdict"] == "fails":
            kinds[re.split(r"[0-9(]", short(r["reason"]).replace("stops at step ", "a step does not converge #"))[0].strip(" #:")].append(int(r["case"].split("_")[1]))
    seeds = [int(r["case"].split("_")[1]) for r in rows]
    stopped = count(rows, "reported")
    out = ["", "# " + title, "",
           "`mortise %s`, %s: %d seeds (%d to %d), **%d clean**%s. Surfaces that met (exact predicates): %d scenes. Values that are not finite: %d. Crashes: %d." % (
               command, j["program"], len(rows), min(seeds), max(seeds), len(rows) - count(rows, "fails"),
               " (%d of them end rightly where supports drive bodies into each other)" % stopped if stopped else "", sum(r["intersections"] > 0 for r in rows), sum(r["not_finite"] > 0 for r in rows),
               sum("signal" in r["unsafe"] for r in rows)), ""]
    if kinds:
        out += ["| what failed | seeds | which |", "|---|---|---|"]
        out += ["| %s | %d | %s |" % (k, len(v), ", ".join(map(str, v))) for k, v in sorted(kinds.items(), key=lambda e: -len(e[1]))]
        out += ["", "`mortise %s --first S --seeds 1` runs seed S again, leaves the scene, takes parts out of it while it fails in the same way, and prints the command that runs" % command,
                "what is left."]
    return out


def main():
    lines = hard(load("result.json"))
    for name, title, command in (("fuzz.json", "Random scenes", "bench fuzz"), ("fuzz_wild.json", "Random scenes that are not tame", "bench fuzz --wild")):
        if load(name):
            lines += fuzz(load(name), title, command)
    notes = os.path.join(HERE, "notes.md")
    if os.path.exists(notes):
        lines += ["", open(notes).read().rstrip()]
    open(os.path.join(HERE, "README.md"), "w").write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
