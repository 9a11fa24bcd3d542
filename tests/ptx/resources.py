#!/usr/bin/env python3
"""Registers, stack and occupancy of every kernel, as ptxas left them in the objects of the CUDA build.

  resources.py CUOBJDUMP OBJECT_FOLDER TABLE.csv            exit code 1 when a kernel needs over 10 % more than the table says, or is not in it
  resources.py CUOBJDUMP OBJECT_FOLDER TABLE.csv --write    writes the table
"""
import argparse
import csv
import re
import subprocess
import sys
from pathlib import Path

THREADS = 128  # of a block (src/device/cuda.h)
# sm_90, per multiprocessor (CUDA C++ Programming Guide, "Technical Specifications per Compute Capability")
REGISTERS, MOST_THREADS, MOST_BLOCKS, GRANULE = 65536, 2048, 32, 256
SLACK = 1.1


def without_arguments(name):
    """Everything in round brackets left out, except the numbers of lambdas."""
    out, depth = "", 0
    for ch in name.replace("{lambda(int)#", "{").replace("(anonymous namespace)", "anonymous"):
        depth += ch == "("
        if depth == 0:
            out += ch
        depth -= ch == ")"
    return out


def arguments(text):
    """Arguments of a template."""
    out, depth = [""], 0
    for ch in text:
        depth += ch in "<{"
        depth -= ch in ">}"
        if ch == "," and depth == 0:
            out.append("")
        else:
            out[-1] += ch
    return [a.strip() for a in out]


def readable(name):
    name = without_arguments(re.sub(r"_GLOBAL__N__[0-9a-f]{8}_", "_GLOBAL__N__", name))  # nvcc's hash of the source's path
    name = re.sub(r"\d\d_GLOBAL__N__\d\d_\w+?_cpp_[0-9a-f]{8}", "_GLOBAL__N_", name)  # the same in names that c++filt cannot read
    if m := re.match(r"void mortise::device::run_kernel<(.*)>$", name):
        name = m[1]
    elif m := re.match(r"void mortise::device::fold_kernel<(.*)>$", name):
        name = f"fold<{arguments(m[1])[2]}>"  # by its terms
    return re.sub(r"\bmortise::|\banonymous::| const\b|\[clone [^]]*\]", "", name).replace("> >", ">>").strip()


def occupancy(registers):
    """Share of the resident threads that a multiprocessor could hold."""
    per_warp = (32 * registers + GRANULE - 1) // GRANULE * GRANULE
    blocks = min(MOST_BLOCKS, MOST_THREADS // THREADS, REGISTERS // per_warp // (THREADS // 32))
    return blocks * THREADS / MOST_THREADS


def measure(cuobjdump, folder):
    rows, raw = {}, []
    for path in sorted(folder.rglob("*.o")):
        text = subprocess.run([cuobjdump, "-res-usage", str(path)], capture_output=True, text=True).stdout
        for name, registers, stack, shared, local in re.findall(r"Function (\S+):\n\s*REG:(\d+) STACK:(\d+) SHARED:(\d+) LOCAL:(\d+)", text):
            raw.append((name, int(registers), int(stack) + int(local), int(shared)))
    names = subprocess.run(["c++filt"], input="\n".join(r[0] for r in raw), capture_output=True, text=True, check=True).stdout.splitlines()
    for name, (_, registers, stack, shared) in zip(names, raw):
        if "cub::" in name:  # not ours to change
            continue
        key, again = readable(name), 2
        while key in rows:  # another object has it too
            key, again = f"{readable(name)} ({again})", again + 1
        rows[key] = {"kernel": key, "registers": registers, "stack_bytes": stack, "shared_bytes": shared, "occupancy": f"{occupancy(registers):.4g}"}
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cuobjdump")
    parser.add_argument("folder", type=Path)
    parser.add_argument("table", type=Path)
    parser.add_argument("--write", action="store_true")
    a = parser.parse_args()
    now = measure(a.cuobjdump, a.folder)
    if a.write:
        with a.table.open("w", newline="") as f:
            out = csv.DictWriter(f, ["kernel", "registers", "stack_bytes", "shared_bytes", "occupancy"], lineterminator="\n")
            out.writeheader()
            out.writerows(now[k] for k in sorted(now))
        return
    with a.table.open() as f:
        before = {row["kernel"]: row for row in csv.DictReader(f)}
    wrong = [f"{k}: not in {a.table.name}" for k in now if k not in before]
    for k, row in now.items():
        for what, small in (("registers", 8), ("stack_bytes", 64)) if k in before else ():
            old = int(before[k][what])
            if row[what] > max(SLACK * old, old + small):
                wrong.append(f"{k}: {what} {old} -> {row[what]}")
    print(f"{len(now)} kernels; largest: {max(r['registers'] for r in now.values())} registers, {max(r['stack_bytes'] for r in now.values())} bytes of stack")
    for line in wrong:
        print("grown:", line)
    for k in sorted(before.keys() - now.keys()):
        print("gone:", k)
    if wrong:
        sys.exit(f"{len(wrong)} kernels need more than {a.table} says; where that is meant: tests/ptx/resources.py ... --write")


if __name__ == "__main__":
    main()
