"""Seconds at the same error, tables and figure of result.json."""
import json
import math
import re

QUANTITIES = {"pressure": "nodal pressures (L2)", "peak": "peak pressure", "radius": "contact radius"}
ASKED = (0.05, 0.01)
COLOURS = {"GMCP consistent": "#0072b2", "GMCP tapered": "#56b4e9", "IPC area-weighted": "#d55e00", "IPC classic": "#e69f00", "CalculiX face-to-face": "#009e73", "CalculiX mortar": "#cc79a7"}


def ladder(result, method, quantity, time="cpu_s"):
    """Seconds and error of a method's finished runs, from coarse to fine."""
    return [(r[time], max(abs(r[quantity]), 1e-6)) for r in result["rows"] if r["method"] == method and quantity in r]


def seconds_at(points, asked):
    """("=", t): the ladder crosses the error at t seconds, between neighbours in log-log, and stays below it. ("<", t): it is below from its coarsest run
    on, t seconds. (">", e): it does not get there, its best error is e. None: no run."""
    if not points:
        return None
    above = [k for k, (_, e) in enumerate(points) if e > asked]
    if not above:
        return "<", points[0][0]
    if above[-1] == len(points) - 1:
        return ">", min(e for _, e in points)
    (t0, e0), (t1, e1) = points[above[-1]:above[-1] + 2]
    w = math.log(e0 / asked) / math.log(e0 / e1)
    return "=", t0 * (t1 / t0) ** w


def time_text(found):
    if not found:
        return "no run"
    sign, value = found
    return {"=": f"{value:.2g} s", "<": f"< {value:.2g} s", ">": f"not reached ({100 * value:.2g} %)"}[sign]


def ratio_text(found, reference):
    """Seconds over those of the reference; a bound where one of them is only bounded."""
    if not found or not reference or ">" in (found[0], reference[0]):
        return ""
    ratio = f"{found[1] / reference[1]:.2g}"
    return {("=", "="): ratio, ("=", "<"): f"> {ratio}", ("<", "="): f"< {ratio}", ("<", "<"): ""}[found[0], reference[0]]


def times_table(result):
    methods = list(dict.fromkeys(r["method"] for r in result["rows"]))
    lines = ["| error of | " + " | ".join(methods) + " |", "|---" * (len(methods) + 1) + "|"]
    for key, title in QUANTITIES.items():
        for asked in ASKED:
            found = {m: seconds_at(ladder(result, m, key), asked) for m in methods}
            ratios = {m: ratio_text(found[m], found[methods[0]]) for m in methods[1:]}
            cells = [time_text(found[m]) + (f"; **{ratios[m]}**" if ratios.get(m) else "") for m in methods]
            lines.append(f"| {title}, {100 * asked:g} % | " + " | ".join(cells) + " |")
    return lines


def runs_table(result):
    lines = ["| mesh | method | CPU s (steps) | MB | iterations | force [N] | " + " | ".join(QUANTITIES.values()) + " |", "|---" * (6 + len(QUANTITIES)) + "|"]
    for r in result["rows"]:
        steps = f" ({r['cpu_solve_s']:.2g})" if "cpu_solve_s" in r else ""
        if "failure" in r:
            errors = [f"× {r['failure']}"] + [""] * (len(QUANTITIES) - 1)
        else:
            errors = [("%.2g %%" if k == "pressure" else "%+.2g %%") % (100 * r[k]) for k in QUANTITIES]
        lines.append(f"| {r['size']} | {r['method']} | {r['cpu_s']:.3g}{steps} | {r.get('peak_MB', '')} | {r.get('iterations', '')} | {r.get('force_N', 0):.0f} | " + " | ".join(errors) + " |")
    m = [f"{s['size']}: {s['vertices']['block'] / 1e3:.1f}k + {s['vertices']['ball'] / 1e3:.1f}k vertices, {1e3 * s['shortest_edge_m']:g} mm" for s in result["meshes"]]
    load = ", ".join(f"{v:.1f}" for v in result["load_average_at_end"])
    calculix = re.sub(r"(?i)^.*version\s*", "CalculiX ", result["calculix"].replace("\n", " ")).strip() or "no CalculiX"
    return lines + ["", f"{'; '.join(m)}. {result['program']}, {calculix}, {result['cpu']}, one thread of {result['cores']} cores, {result['date']}; load average at the end {load} (above 1: other work ran beside it)."]


WIDTH, HEIGHT, LEFT, TOP, BOTTOM, RIGHT = 430, 300, 58, 34, 44, 12


def figure(result):
    """Error over CPU seconds, a panel per quantity; runs that failed stand as crosses above the panel at the time they took."""
    methods = list(dict.fromkeys(r["method"] for r in result["rows"]))
    low, high = (f(r["cpu_s"] for r in result["rows"] if r["cpu_s"] > 0) for f in (min, max))
    x0, x1 = math.log10(low) - 0.1, math.log10(high) + 0.1
    y0, y1 = -4, 0.3
    svg = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * WIDTH}" height="{2 * HEIGHT + 30}" viewBox="0 0 {2 * WIDTH} {2 * HEIGHT + 30}" font-family="sans-serif" font-size="12">',
           '<rect width="100%" height="100%" fill="white"/>']
    for i, (key, title) in enumerate(QUANTITIES.items()):
        left, top = WIDTH * (i % 2) + LEFT, HEIGHT * (i // 2) + TOP
        right, bottom = left - LEFT + WIDTH - RIGHT, top - TOP + HEIGHT - BOTTOM
        x = lambda t: left + (right - left) * (math.log10(t) - x0) / (x1 - x0)  # noqa: E731
        y = lambda e: bottom - (bottom - top) * (min(max(math.log10(e), y0), y1) - y0) / (y1 - y0)  # noqa: E731
        svg.append(f'<text x="{left}" y="{top - 12}" font-size="13" font-weight="bold">{title}</text>')
        for power in range(math.ceil(x0), math.floor(x1) + 1):
            for digit in (1, 2, 5):
                t = digit * 10.0 ** power
                if x0 <= math.log10(t) <= x1:
                    svg.append(f'<line x1="{x(t):.1f}" x2="{x(t):.1f}" y1="{top}" y2="{bottom}" stroke="#e8e8e8"/><text x="{x(t):.1f}" y="{bottom + 16}" text-anchor="middle">{t:g}</text>')
        for e in (1e-4, 1e-3, 1e-2, 5e-2, 1e-1, 1):
            dashed = ' stroke-dasharray="4 3"' if e in ASKED else ""
            svg.append(f'<line x1="{left}" x2="{right}" y1="{y(e):.1f}" y2="{y(e):.1f}" stroke="{"#909090" if dashed else "#e8e8e8"}"{dashed}/><text x="{left - 6}" y="{y(e) + 4:.1f}" text-anchor="end">{100 * e:g} %</text>')
        for m in methods:
            points = ladder(result, m, key)
            if points:
                path = " ".join(f"{x(t):.1f},{y(e):.1f}" for t, e in points)
                svg.append(f'<polyline points="{path}" fill="none" stroke="{COLOURS[m]}" stroke-width="2"/>')
                svg += [f'<circle cx="{x(t):.1f}" cy="{y(e):.1f}" r="3.5" fill="{COLOURS[m]}"/>' for t, e in points]
            for r in result["rows"]:
                if r["method"] == m and "failure" in r and r["cpu_s"] > 0:
                    svg.append(f'<text x="{x(r["cpu_s"]):.1f}" y="{top + 10}" fill="{COLOURS[m]}" text-anchor="middle" font-size="15">×</text>')
        svg.append(f'<text x="{(left + right) / 2}" y="{bottom + 34}" text-anchor="middle">CPU seconds, whole process</text>')
    for k, m in enumerate(methods):
        at = 20 + k * (2 * WIDTH - 20) / len(methods)
        svg.append(f'<circle cx="{at}" cy="{2 * HEIGHT + 16}" r="5" fill="{COLOURS[m]}"/><text x="{at + 10}" y="{2 * HEIGHT + 20}">{m}</text>')
    return "\n".join(svg + ["</svg>"]) + "\n"


def write(folder):
    result = json.loads((folder / "result.json").read_text())
    (folder / "figure.svg").write_text(figure(result))
    readme = folder / "README.md"
    text = readme.read_text()
    for mark, lines in (("times", times_table(result)), ("runs", runs_table(result))):
        text = re.sub(rf"(<!-- {mark} -->\n).*?(<!-- end -->)", lambda found: found[1] + "\n".join(lines) + "\n" + found[2], text, flags=re.S)
    readme.write_text(text)
