#!/usr/bin/env python3
"""Reads the field file of several environments with VTK itself (vtkHDFReader) and with h5py, against the environments' own files; checks run.json against its schema.

    read_environments.py MORTISE WORK_DIR SCHEMAS
"""
import csv
import json
import os
import shutil
import subprocess
import sys

import h5py
import jsonschema
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

# Blocks that hit the floor fail: four Newton iterations are too few.
SCENE = """
mortise: 1
name: drop
time: {step: 5 ms, steps: 6, frame_every: 2}
environments: {count: 3, seed: 6, vary: {path: bodies.block.velocity.2, abs: {choice: [0 m/s, -0.6 m/s]}}}
materials: {gel: {youngs_modulus: 0.1 MPa, poisson_ratio: 0.3, density: 1000, model: linear}}
bodies:
  block: {type: soft, shape: {box: {size: [10 mm, 10 mm, 10 mm], edge_length: 5 mm}}, material: gel, position: [0, 0, 12 mm]}
  floor: {type: half_space}
effects: {inertia: {}, elasticity: {}, barrier_contact: {}}
solver: {iterations: 4, halvings: 0}
"""


def main(mortise, work, schemas):
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    scene, out = os.path.join(work, "drop.yaml"), os.path.join(work, "out")
    with open(scene, "w") as f:
        f.write(SCENE)
    code = subprocess.run([mortise, "run", scene, "-o", out, "-q", "--device", "cpu"], capture_output=True).returncode
    assert code == 5, code
    with open(os.path.join(schemas, "run.schema.json")) as s, open(os.path.join(out, "run.json")) as r:
        run = json.load(r)
        jsonschema.validate(run, json.load(s))
    assert run["status"] == "failed" and "environments failed" in run["message"]
    with open(os.path.join(out, "environments.csv"), newline="") as f:
        rows = list(csv.DictReader(f))
    status = [row["status"] for row in rows]
    assert sorted(set(status)) == ["done", "failed"], status

    path = os.path.join(out, "fields.vtkhdf")
    with h5py.File(path) as all:
        assert all.attrs["filetype"] == "mortise environments" and all.attrs["count"] == 3
        values = all["environments/values/bodies.block.velocity.2"][:]
        assert np.array_equal(values, [float(row["bodies.block.velocity.2"]) for row in rows])
        assert np.array_equal(all["environments/exit_code"][:], [int(row["exit_code"]) for row in rows])
        u, energy, time = all["environments/PointData/displacement"], all["environments/effects/elasticity/energy"], all["environments/time"]
        newton = all["environments/steps/newton_iterations"]
        assert u.shape == (3, 4, 27, 3) and energy.shape == time.shape == (3, 4), (u.shape, energy.shape)
        assert u.attrs["unit"] == "m" and newton.shape[0] == 3
        shorter = 0
        for e in range(3):
            with h5py.File(os.path.join(out, f"env_{e:04d}", "fields.vtkhdf")) as own:
                frames = int(own["VTKHDF/Steps"].attrs["NSteps"])
                assert np.array_equal(u[e, :frames].reshape(-1, 3), own["VTKHDF/PointData/displacement"][: 27 * frames])
                assert np.array_equal(energy[e, :frames], own["mortise/effects/elasticity/energy"][:frames])
                assert np.array_equal(newton[e, : len(own["mortise/steps/newton_iterations"])], own["mortise/steps/newton_iterations"][:])
                assert np.isnan(u[e, frames:]).all() and np.isnan(energy[e, frames:]).all()
                shorter += frames < 4
                assert (frames < 4) == (status[e] == "failed")
        assert 0 < shorter < 3
        last = [np.flatnonzero(~np.isnan(time[e]))[-1] for e in range(3)]
        points = [all["environments/Points"][e, last[e]] for e in range(3)]
        times = time[int(np.argmax(last))]

    # The same with resets: what episodes wrote follows each other along the frames and steps of their environment.
    again = os.path.join(work, "resets")
    subprocess.run([mortise, "run", scene, "-o", again, "-q", "--device", "cpu", "--set", "solver.iterations=100", "--set", "environments.reset=[{after: 15 ms}]"], check=True)
    with h5py.File(os.path.join(again, "fields.vtkhdf")) as all:
        of, step, u = all["environments/episode"][:], all["environments/steps/step"][:], all["environments/PointData/displacement"]
        assert np.array_equal(of, np.tile([0, 0, 0, 1, 1, 1], (3, 1))), of  # frames after 0, 2, 3 steps
        assert np.array_equal(step, np.tile([1, 2, 3, 1, 2, 3], (3, 1))), step
        for e in range(3):
            for j in range(2):
                with h5py.File(os.path.join(again, f"env_{e:04d}", f"episode_{j:04d}", "fields.vtkhdf")) as own:
                    assert np.array_equal(u[e, 3 * j : 3 * j + 3].reshape(-1, 3), own["VTKHDF/PointData/displacement"][: 27 * 3])

    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    steps = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    assert np.allclose(steps, times), (steps, times)
    errors = []
    reader.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    reader.UpdateTimeStep(steps[-1])
    blocks = reader.GetOutputDataObject(0)
    assert blocks.GetNumberOfBlocks() == 3
    for e in range(3):
        grid = blocks.GetBlock(e)
        assert blocks.GetMetaData(e).Get(vtk.vtkCompositeDataSet.NAME()) == f"env_{e:04d}"
        assert np.array_equal(vtk_to_numpy(grid.GetPoints().GetData()), points[e]), e
        assert grid.GetPointData().HasArray("displacement")
    assert not errors
    print("read back with VTK", vtk.VTK_VERSION, "and h5py:", status)


if __name__ == "__main__":
    main(*sys.argv[1:])
