#!/usr/bin/env python3
"""An effect that is off costs nothing: off_costs_nothing.py MORTISE FOLDER

Counts the instructions of the steps (callgrind) of a scene in which an effect was switched off, as `mortise study --effects` does it (the resolved scene
without the effect's block and without what follows it), and of the same scene written by somebody who never heard of the effect. They may differ by
1 %, and no function of the effect may run. Of the scene with the effect on some must, or the test would see nothing. Exit code 77: no valgrind here.
"""

import pathlib
import re
import shutil
import subprocess
import sys

# Of every effect some scene below has it on.
SCENES = {
    "cubes": """\
mortise: 1
name: cubes
time: {step: 5 ms, steps: 2}
materials:
  gel: {model: neo_hookean, youngs_modulus: 0.1 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.05}}, material: gel, position: [0, 0, 0.0502]}
  cube: {type: stiff, shape: {box: {size: [0.1, 0.1, 0.1], edge_length: 0.1}}, material: gel, position: [0.3, 0, 0.0502]}
  arm: {type: stiff, shape: {box: {size: [0.1, 0.02, 0.02], edge_length: 0.1}}, material: gel, position: [-0.3, 0, 0.3]}
  floor: {type: half_space}
effects:
  inertia: {}
  gravity: {}
  elasticity: {}
  affine_body: {stiffness: 1 MPa}
  pin: [{body: pad, where: {side: z_max}, axes: xy}]
  joint: [{name: hip, type: revolute, body: arm, at: [-0.35, 0, 0.3], axis: [0, 1, 0]}]
  pressure_load: [{body: pad, where: {side: z_max}, pressure: 10 Pa}]
  barrier_contact: {d_hat: 1 mm, stiffness: 10 kPa}
  friction: {follows: barrier_contact, mu: 0.3}
output: {pictures: false, checkpoint_every: {steps: 1000}}
""",
    "finger": """\
mortise: 1
name: finger
time: {step: 5 ms, steps: 2}
materials:
  gel: {model: linear, youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000}
bodies:
  pad: {type: soft, shape: {box: {size: [0.1, 0.1, 0.05], edge_length: 0.05}}, material: gel, position: [0, 0, 0.025]}
  cover: {type: soft, shape: {box: {size: [0.1, 0.1, 0.05], edge_length: 0.04}}, material: gel, position: [0, 0, 0.075]}
  punch: {type: stiff, shape: {box: {size: [0.06, 0.06, 0.02], edge_length: 0.06}}, material: gel, position: [0, 0, 0.1102]}
  arm: {type: stiff, shape: {box: {size: [0.1, 0.02, 0.02], edge_length: 0.1}}, material: gel, position: [-0.3, 0, 0.3]}
  tip: {type: soft, shape: {box: {size: [0.02, 0.02, 0.02], edge_length: 0.02}}, material: gel, position: [-0.24, 0, 0.3]}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {stiffness: 1 MPa}
  pin: [{body: pad, where: {side: z_min}}]
  mortar_tie: [{body: cover, where: {side: z_min}, to: pad}]
  bond: [{body: tip, to: arm, within: 0}]
  joint: [{name: hip, type: revolute, body: arm, at: [-0.35, 0, 0.3], axis: [0, 1, 0]}]
  drive: [{joint: hip, mode: pd, kp: 1, kd: 0.01, effort: 1, velocity: 20, angle: 0.1}]
  mortar_contact: {d_hat: 0.5 mm, stiffness: 0.1 MPa, pairs: [{slave: cover, master: punch}]}
output: {pictures: false, checkpoint_every: {steps: 1000}}
""",
}


class Case:
    """An effect of a scene, and what goes with it: effects that follow it, bodies that cannot do without. seen: in the names of its functions."""

    def __init__(self, scene, effect, *gone, set=(), seen=None):
        camel = "".join(word.capitalize() for word in effect.split("_"))
        self.scene, self.effect, self.gone, self.set = scene, effect, [effect, *gone], list(set)
        self.seen = rf"::{camel}s?::|effects::{effect}::" if seen is None else seen

    def of_effect(self, functions):
        return sorted(f for f in functions if self.seen and re.search(self.seen, f))


CASES = [
    Case("cubes", "gravity"),
    Case("cubes", "pin"),
    Case("cubes", "joint"),
    Case("cubes", "pressure_load"),
    Case("cubes", "friction"),
    Case("cubes", "barrier_contact", "friction"),
    Case("cubes", "affine_body", "cube", "arm", "joint"),
    Case("finger", "mortar_contact"),
    Case("finger", "mortar_tie", "bond", seen="::TieEffect::"),  # bonds are ties as well:
    Case("finger", "bond", seen=""),  # where the others stay, names do not tell them apart
    Case("finger", "drive"),
    Case("finger", "elasticity", "pad", "cover", "tip", "pin", "mortar_tie", "bond", "mortar_contact"),
    Case("finger", "inertia", "punch", "mortar_contact", "arm", "tip", "bond", "joint", "drive", "affine_body", set=["time={mode: static, steps: 2}"]),
]
MOST = 0.01  # of the instructions of the steps


def without_lines(text, names):
    """The scene of somebody who never heard of them."""
    return "".join(l for l in text.splitlines(True) if not any(re.match(rf"  {n}:", l) for n in names))


def without_blocks(text, names):
    """A resolved scene with these bodies and effects taken out."""
    out, inside, dropping = [], False, False
    for line in text.splitlines(True):
        if not line.startswith(" "):
            inside, dropping = line.startswith(("effects:", "bodies:")), False
        elif inside and re.match(r"  [a-z_]+:", line):
            dropping = line.split(":")[0].strip() in names
        if not dropping:
            out.append(line)
    return "".join(out)


def steps_of(program, folder, name, scene, sets=()):
    """Instructions of the steps, and the names of the functions that they went through."""
    path, profile = folder / f"{name}.yaml", folder / f"{name}.callgrind"
    path.write_text(scene)
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={profile}", "--toggle-collect=mortise::solver::Simulation::step(*",
               program, "run", path, "-o", folder / name, "--overwrite", "--no-render", "--quiet", "--device", "cpu", "--threads", "1"]
    for s in sets:
        command += ["--set", s]
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{name}: exit code {done.returncode}\n{done.stderr}")
    text = profile.read_text()
    count = int(re.search(r"^(?:summary|totals): (\d+)", text, re.M).group(1))
    return count, set(re.findall(r"fn=\(\d+\) (.+)", text))


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    if shutil.which("valgrind") is None:
        print("valgrind is not here: instructions are not counted")
        sys.exit(77)
    folder.mkdir(parents=True, exist_ok=True)
    resolved, all_count, all_functions = {}, {}, {}
    for name, scene in SCENES.items():
        path = folder / f"{name}.yaml"
        path.write_text(scene)
        resolved[name] = subprocess.run([program, "check", path, "--print-resolved"], check=True, capture_output=True, text=True).stdout
        all_count[name], all_functions[name] = steps_of(program, folder, name, scene)
    print(f"{'effect':18} {'on':>12} {'off':>12} {'never named':>12}  off/never named")
    wrong = []
    for case in CASES:
        effect = case.effect
        off, functions = steps_of(program, folder, f"{effect}_off", without_blocks(resolved[case.scene], case.gone), case.set)
        never, _ = steps_of(program, folder, f"{effect}_never", without_lines(SCENES[case.scene], case.gone), case.set)
        print(f"{effect:18} {all_count[case.scene]:12} {off:12} {never:12}  {off / never - 1:+.4%}", flush=True)
        if never < 10000:
            wrong.append(f"{effect}: {never} instructions are no step: nothing was counted")
        if abs(off / never - 1) > MOST:
            wrong.append(f"{effect}: off it costs {off} instructions, never named {never}")
        if case.of_effect(functions):
            wrong.append(f"{effect}: is off, and these ran: {', '.join(f[:80] for f in case.of_effect(functions)[:5])}")
        if case.seen and not case.of_effect(all_functions[case.scene]):
            wrong.append(f"{effect}: is on, and no function of it is seen to run: this test is blind")
    sys.exit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main()
