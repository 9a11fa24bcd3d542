#!/usr/bin/env python3
"""The Hertz benchmark in CalculiX on the same meshes: seconds, peak memory and pressure beside mortise.

    benchmarks/peers/calculix.py MORTISE [SIZE ...] [--result FILE] [--limit SECONDS]

MORTISE is the program; SIZE is one of its Hertz sizes (coarse, medium, isaac, fine; default coarse). Needs `ccx` (Debian: calculix-ccx) and
leaves at once, with 0, where it is not installed. Everything runs on one thread. CalculiX gets the deck in mm and MPa (its
mortar contact refuses decks in metres), linear tetrahedra C3D4, imposed displacement, frictionless contact with the block as slave:
  face-to-face   *CONTACT PAIR, TYPE=SURFACE TO SURFACE, linear pressure-overclosure of slope 100 E/h
  mortar         *CONTACT PAIR, TYPE=MORTAR, hard contact (dual Lagrange multipliers). It stops without a word where nodes of the slave are
                 held, so the symmetry of these nodes is kept by springs of 1e4 N/mm, 600 times as stiff as the elements
Compared is the nodal traction on the block's face (nodal force over area at rest) with Hertz at the run's own force, as in `mortise bench hertz`.
"""
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import time

FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # of C3D4, S1 .. S4
RADIUS, TRAVEL, YOUNG, POISSON = 1.0, 0.0095, 1.0, 0.3  # m, m, MPa
MM = 1000.0


def surface(tets):
    """Boundary faces as {sorted nodes: (tet, face, nodes)}."""
    seen = {}
    for t, tet in enumerate(tets):
        for f, corners in enumerate(FACES):
            nodes = tuple(tet[c] for c in corners)
            key = tuple(sorted(nodes))
            if key in seen:
                del seen[key]
            else:
                seen[key] = (t, f, nodes)
    return list(seen.values())


def wrapped(values, n=12):
    return "\n".join(", ".join(map(str, values[i:i + n])) + "," for i in range(0, len(values), n))


def deck(meshes, kind, stiffness, travel=None):
    """The Abaqus deck, and the faces of the block's upper side. travel: of the lid [m]; None: as far as `mortise bench hertz` goes, whose bodies start
    0.3 d_hat apart and would overlap by TRAVEL - 0.1 d_hat."""
    lines, offset, elements = ["*HEADING", "Hertz", "*NODE, NSET=NALL"], {}, {}
    count = cells = 0
    for body, mesh in meshes.items():
        offset[body] = count
        lines += [f"{count + i + 1}, {x * MM!r}, {y * MM!r}, {z * MM!r}" for i, (x, y, z) in enumerate(mesh["points"])]
        count += len(mesh["points"])
    for body, mesh in meshes.items():
        lines.append(f"*ELEMENT, TYPE=C3D4, ELSET=E{body}")
        elements[body] = cells
        o = offset[body]
        lines += [f"{cells + i + 1}, {a + o + 1}, {b + o + 1}, {c + o + 1}, {d + o + 1}" for i, (a, b, c, d) in enumerate(mesh["tets"])]
        cells += len(mesh["tets"])
    block, ball = meshes["block"]["points"], meshes["ball"]["points"]
    if travel is None:
        gap = min(p[2] for p in ball)
        travel = TRAVEL - gap / 3 + gap
    deepest, top = min(p[2] for p in block), max(p[2] for p in ball)
    sets = {
        "BASE": [i for i, p in enumerate(block) if p[2] < deepest + 1e-9],
        "LID": [i + offset["ball"] for i, p in enumerate(ball) if p[2] > top - 1e-9],
        "XSYM": [i + offset[b] for b in meshes for i, p in enumerate(meshes[b]["points"]) if p[0] < 1e-9],
        "YSYM": [i + offset[b] for b in meshes for i, p in enumerate(meshes[b]["points"]) if p[1] < 1e-9],
    }
    upper = [f for f in surface(meshes["block"]["tets"]) if all(abs(block[n][2]) < 1e-9 for n in f[2])]
    reach = 0.25  # m: what can come into contact, with a wide margin
    slave = [f for f in upper if all(math.hypot(*block[n][:2]) < reach for n in f[2])]
    pole = min(p[2] for p in ball)
    master = [f for f in surface(meshes["ball"]["tets"]) if all(ball[n][2] < pole + reach * reach and math.hypot(*ball[n][:2]) < 1.4 * reach for n in f[2])
              and not all(ball[n][0] < 1e-9 for n in f[2]) and not all(ball[n][1] < 1e-9 for n in f[2])]
    springs = []
    if kind == "mortar":
        for name, axis in (("XSYM", 0), ("YSYM", 1)):
            loose = sorted({n for f in upper for n in f[2] if block[n][axis] < 1e-9})
            sets[name] = [n for n in sets[name] if n - offset["block"] not in set(loose)]
            springs.append(f"*ELEMENT, TYPE=SPRING1, ELSET=S{name}")
            springs += [f"{cells + i + 1}, {n + offset['block'] + 1}" for i, n in enumerate(loose)]
            cells += len(loose)
        springs += ["*SPRING, ELSET=SXSYM", "1", "10000.0", "*SPRING, ELSET=SYSYM", "2", "10000.0"]
    for name, nodes in sets.items():
        lines += [f"*NSET, NSET={name}", wrapped([n + 1 for n in nodes])]
    for name, faces, body in (("SLAVE", slave, "block"), ("MASTER", master, "ball")):
        lines.append(f"*SURFACE, NAME={name}")
        lines += [f"{elements[body] + t + 1}, S{f + 1}" for t, f, _ in faces]
    lines += springs + ["*MATERIAL, NAME=RUBBER", "*ELASTIC", f"{YOUNG}, {POISSON}"]
    lines += [f"*SOLID SECTION, ELSET=E{body}, MATERIAL=RUBBER" for body in meshes]
    lines += ["*SURFACE INTERACTION, NAME=CONTACT"]
    if kind == "mortar":
        lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD", "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=MORTAR", "SLAVE, MASTER"]
    else:
        lines += ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{stiffness!r},", "*CONTACT PAIR, INTERACTION=CONTACT, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", "BASE, 1, 3", "XSYM, 1, 1", "YSYM, 2, 2", "*STEP, INC=100", "*STATIC, SOLVER=SPOOLES", "1., 1.", "*BOUNDARY", f"LID, 3, 3, {-travel * MM!r}",
              "*NODE PRINT, NSET=LID, TOTALS=ONLY", "RF", "*NODE PRINT, NSET=NALL", "U", "*EL PRINT, ELSET=Eblock", "S", "*END STEP"]
    return "\n".join(lines) + "\n", upper


def blocks_of(dat):
    """{title: rows} of the last increment in a .dat file."""
    out, rows = {}, None
    for line in dat.splitlines():
        words = line.split()
        if not words:
            continue
        if words[0][0].isalpha():
            rows = out[line.split("(")[0].strip()] = []
        elif rows is not None:
            rows.append([float(w) for w in words])
    return out


def nodal_forces(mesh, stress):
    """Internal nodal forces in z of the block, from the constant stress of every tetrahedron: V grad(N_a) . sigma."""
    force = [0.0] * len(mesh["points"])
    for tet, s in zip(mesh["tets"], stress):
        p = [[c * MM for c in mesh["points"][n]] for n in tet]
        for a in range(4):
            i, j, k = (n for n in range(4) if n != a)
            u, v = [p[j][d] - p[i][d] for d in range(3)], [p[k][d] - p[i][d] for d in range(3)]
            n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]  # twice the area of the opposite face
            w = [p[a][d] - p[i][d] for d in range(3)]
            sign = 1 if sum(x * y for x, y in zip(n, w)) > 0 else -1
            force[tet[a]] += sign * (s[4] * n[0] + s[5] * n[1] + s[2] * n[2]) / 6  # xz, yz, zz
    return force


def stresses_of(tables):
    """Of every tetrahedron of the block [MPa]."""
    return [row[2:8] for row in next(rows for title, rows in tables.items() if title.startswith("stresses"))]


def hertz(force):
    """Contact radius [mm] and peak pressure [MPa] at this force of the whole ball [N]."""
    e_star, R = YOUNG / (2 * (1 - POISSON * POISSON)), RADIUS * MM
    a = (3 * force * R / (4 * e_star)) ** (1 / 3)
    return a, 3 * force / (2 * math.pi * a * a)


def accuracy(meshes, upper, dat):
    tables = blocks_of(dat)
    total = next(rows for title, rows in tables.items() if title.startswith("total force"))[-1]
    stress = stresses_of(tables)
    moved = {int(r[0]) - 1: r[1:4] for r in next(rows for title, rows in tables.items() if title.startswith("displacements"))}
    mesh = meshes["block"]
    force, area = nodal_forces(mesh, stress), {}
    for _, _, nodes in upper:
        p = [mesh["points"][n] for n in nodes]
        u, v = [p[1][d] - p[0][d] for d in range(3)], [p[2][d] - p[0][d] for d in range(3)]
        twice = abs(u[0] * v[1] - u[1] * v[0]) * MM * MM
        for n in nodes:
            area[n] = area.get(n, 0) + twice / 6
    F = 4 * abs(total[2])  # N
    a, p0 = hertz(F)
    wrong = every = peak = 0.0
    for n, A in area.items():
        x, y, _ = mesh["points"][n]
        r, p = math.hypot(x * MM + moved[n][0], y * MM + moved[n][1]), -force[n] / A
        exact = p0 * math.sqrt(1 - r * r / (a * a)) if r < a else 0.0
        peak = max(peak, p)
        if r <= a:
            wrong, every = wrong + A * (p - exact) ** 2, every + A * exact * exact
    return {"force_N": F, "pressure_l2": math.sqrt(wrong / every), "peak_over_p0": peak / p0}


def measured(command, cwd, limit):
    """Wall and CPU seconds and peak memory of a command on one thread."""
    env = dict(os.environ, OMP_NUM_THREADS="1", CCX_NPROC_EQUATION_SOLVER="1", CCX_NPROC_STIFFNESS="1", CCX_NPROC_RESULTS="1")
    began = time.time()
    with open(os.path.join(cwd, "log.txt"), "w") as log:
        child = subprocess.Popen(command, cwd=cwd, env=env, stdout=log, stderr=subprocess.STDOUT)
        while True:
            pid, status, usage = os.wait4(child.pid, os.WNOHANG)
            if pid:
                break
            if time.time() - began > limit:
                child.kill()
            time.sleep(0.05)
    child.returncode = os.waitstatus_to_exitcode(status)
    return {"exit": child.returncode, "wall_s": round(time.time() - began, 2), "cpu_s": round(usage.ru_utime + usage.ru_stime, 2), "peak_MB": round(usage.ru_maxrss / 1024)}


def mortise_row(program, size, folder, linear):
    run = measured([program, "bench", "hertz", "--threads", "1", "--json", "--set", "methods=gmcp_consistent", "--set", f"size={size}", "--set", f"solver.linear={linear}", "--set", f"mesh={folder}/mesh.json", "--out", folder], folder, 1e9)
    rows = {r["quantity"]: r for r in (json.loads(line) for line in open(os.path.join(folder, "log.txt")) if line.startswith("{"))}
    peak = rows["peak pressure"]
    return dict(run, code="mortise", method=f"gmcp consistent, {linear}", force_N=4 * rows["contact force"]["value"], pressure_l2=rows["pressure L2, r <= a"]["value"], peak_over_p0=peak["value"] / peak["reference"],
                iterations=peak["newton_iterations"])


def main():
    arguments = sys.argv[1:]
    result, limit = None, 1800.0
    for flag in ("--result", "--limit"):
        if flag in arguments:
            i = arguments.index(flag)
            value = arguments[i + 1]
            del arguments[i:i + 2]
            result, limit = (value, limit) if flag == "--result" else (result, float(value))
    if not arguments:
        sys.exit(__doc__)
    ccx = shutil.which("ccx")
    if not ccx:
        print("skipped: no ccx (Debian: apt-get install calculix-ccx)")
        return
    program, sizes = os.path.abspath(arguments[0]), arguments[1:] or ["coarse"]
    table = []
    for size in sizes:
        with tempfile.TemporaryDirectory() as folder:
            for linear in ("direct", "cg"):
                row = dict(mortise_row(program, size, folder, linear), size=size)
                meshes = json.load(open(os.path.join(folder, "mesh.json")))
                row["vertices"] = {b: len(m["points"]) for b, m in meshes.items()}
                table.append(row)
                print(row, flush=True)
            h = min(math.dist(meshes["block"]["points"][0], p) for p in meshes["block"]["points"][1:])
            for kind in ("face-to-face", "mortar"):
                text, upper = deck(meshes, kind, 100 * YOUNG / (h * MM))
                open(os.path.join(folder, "hertz.inp"), "w").write(text)
                row = dict(measured([ccx, "-i", "hertz"], folder, limit), code="CalculiX 2.20", method=kind, size=size)
                log = open(os.path.join(folder, "log.txt"), errors="replace").read()
                row["iterations"] = log.count("iteration ")
                if row["exit"] == 0 and "Job finished" in log:
                    row.update(accuracy(meshes, upper, open(os.path.join(folder, "hertz.dat")).read()))
                else:
                    row["failure"] = next((l.strip() for l in log.splitlines() if "ERROR" in l), "stopped at the time limit")
                table.append(row)
                print(row, flush=True)
    if result:
        cpu = next((l.split(":")[1].strip() for l in open("/proc/cpuinfo") if l.startswith("model name")), "")
        json.dump({"machine": cpu, "program": subprocess.run([program, "--version"], capture_output=True, text=True).stdout.strip(), "load_average_at_end": os.getloadavg(), "rows": table}, open(result, "w"), indent=1)


if __name__ == "__main__":
    main()
