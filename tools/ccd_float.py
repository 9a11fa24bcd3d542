#!/usr/bin/env python3
"""How collision detection would do in single precision: tools/ccd_float.py FOLDER (of the queries of `mortise bench ccd`).

There is no float build of the program. This compiles src/geometry/collide/ccd.h with `float` for `double` and the constants of floats, and
counts missed impacts and false ones. Two truths: that of the file, whose vertices are exact doubles and move when they are rounded to
floats, and the double code's answer for the rounded vertices.
"""
import os
import re
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

SRC = Path(__file__).resolve().parent.parent / "src"
CONSTANTS = {"2.220446049250313e-16": "1.1920929e-7f", "kParallel = 1e-16": "kParallel = 1e-8f", "kNarrow = 1e-14": "kNarrow = 1e-6f", "kTolerance = 1e-6": "kTolerance = 1e-4f",
             "distance > 1e-6 * c.size": "distance > 1e-4f * c.size"}
MAIN = r"""
#include <cstdio>
#include "base/types.h"
#include "geometry/collide/ccd.h"
#include "floats/geometry/collide/ccd.h"
template <class V, class P, class E> bool impact(const double (&v)[24], bool edges, P points, E edge) {
  V a[4], b[4];
  for (int i = 0; i < 4; ++i) for (int k = 0; k < 3; ++k) a[i][k] = (float)v[3 * i + k], b[i][k] = (float)v[12 + 3 * i + k];
  return (edges ? edge(a, b, 0, 1) : points(a, b, 0, 1)) <= 1;
}
int main() {
  long n[2] = {}, hits[2] = {}, missed[2] = {}, false_[2] = {}, missed_d[2] = {}, false_d[2] = {};
  int edges, truth;
  double v[24];
  while (std::scanf("%d %d", &edges, &truth) == 2) {
    for (double& c : v) if (std::scanf("%lf", &c) != 1) return 1;
    const bool f = impact<mortise_float::Vec3>(v, edges, mortise_float::geometry::ccd_point_triangle, mortise_float::geometry::ccd_edge_edge);
    const bool d = impact<mortise::Vec3>(v, edges, mortise::geometry::ccd_point_triangle, mortise::geometry::ccd_edge_edge);
    ++n[edges], hits[edges] += truth, missed[edges] += truth && !f, false_[edges] += !truth && f, missed_d[edges] += d && !f, false_d[edges] += !d && f;
  }
  for (int e = 0; e < 2; ++e)
    std::printf("%s: %ld queries, %ld impacts; float against the file: %ld missed, %ld false; against double at the rounded vertices: %ld missed, %ld more found\n",
                e ? "edge-edge" : "point-triangle", n[e], hits[e], missed[e], false_[e], missed_d[e], false_d[e]);
}
"""


def main():
    with tempfile.TemporaryDirectory() as tmp:
        for name in ("base/types.h", "base/hd.h", "geometry/collide/distance.h", "geometry/collide/ccd.h"):
            text = (SRC / name).read_text()
            for old, new in CONSTANTS.items():
                text = text.replace(old, new)
            if name != "base/hd.h":
                text = re.sub(r"\bdouble\b", "float", text).replace("namespace mortise", "namespace mortise_float").replace('#include "', '#include "floats/')
            path = Path(tmp) / "floats" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        (Path(tmp) / "main.cpp").write_text(MAIN)
        program = os.path.join(tmp, "main")
        subprocess.run(["g++", "-std=c++20", "-O2", "-ffp-contract=off", "-DEIGEN_MAX_STATIC_ALIGN_BYTES=0", "-I", tmp, "-I", str(SRC), "-isystem", "/usr/include/eigen3",
                        os.path.join(tmp, "main.cpp"), "-o", program], check=True)
        lines = []
        for file in sorted(Path(sys.argv[1]).glob("*.csv")):
            rows = [line.split(",") for line in file.read_text().split()]
            for i in range(0, len(rows), 8):
                query = rows[i:i + 8]
                values = [float(Fraction(int(r[2 * d]), int(r[2 * d + 1]))) for r in query for d in range(3)]
                lines.append("%d %s %s" % ("edge-edge" in file.name, query[0][6], " ".join("%.17g" % v for v in values)))
        print(subprocess.run([program], input="\n".join(lines), capture_output=True, text=True, check=True).stdout, end="")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main()
