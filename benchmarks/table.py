#!/usr/bin/env python3
"""Writes the table of a result into a README: table.py README.md result.json

The README says where: between `<!-- result.json -->` and `<!-- end -->` (each on a line of its own). Without these lines nothing happens.
"""
import json
import os
import sys


def error(row):
    if row is None:
        return ""
    if row["value"] is None:
        return "fails"
    e = row["error"]
    if e is None:
        return ""
    if row["reference"] is None and row["quantity"].endswith("iterations"):
        return f"{row['value']:g}"
    if e < 1e-5:
        return f"{e:.1e}"
    if row["quantity"].startswith("rate"):
        return f"rate {row['value']:.2f}"
    return f"{e:.2f}" if "[deg]" in row["quantity"] else f"{100 * e:.2g} %"


def table(result):
    rows = result["rows"]
    methods = list(dict.fromkeys(r["method"] for r in rows))
    lines = ["| case | error of | " + " | ".join(m.replace("_", " ") for m in methods) + " | gate |", "|---" * (len(methods) + 3) + "|"]
    for key in dict.fromkeys((r["case"], r["quantity"]) for r in rows):
        of = {r["method"]: r for r in rows if (r["case"], r["quantity"]) == key}
        gates = [r["gate"] for r in of.values() if r["gate"] is not None]
        lines.append("| " + " | ".join(key) + " | " + " | ".join(error(of.get(m)) for m in methods) + " | " + (f"{gates[0]:g}" if gates else "") + " |")
    machine = result["machine"]
    load = ", ".join(f"{v:.1f}" for v in machine.get("load_average", []))
    lines += ["", f"{result['program']}, {machine['cpu']}, one thread of {machine['cores']} cores; load average at the end {load} (above 1: other work ran beside it)."]
    return lines


def main():
    readme, path = sys.argv[1:]
    begin, end = f"<!-- {os.path.basename(path)} -->", "<!-- end -->"
    lines = open(readme).read().splitlines()
    if begin not in lines:
        return
    first = lines.index(begin)
    last = lines.index(end, first)
    lines[first + 1:last] = table(json.load(open(path)))
    open(readme, "w").write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
