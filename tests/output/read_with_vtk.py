#!/usr/bin/env python3
"""Reads field files with VTK itself (vtkHDFReader) and with h5py, frame by frame, and the sidecar with VTK's XDMF reader;
checks run.json against its schema.

    read_with_vtk.py WRITER WORK_DIR SCHEMAS

WRITER is the program of tests/output/write_sample.cpp. Needs vtk (>= 9.3), h5py, numpy and jsonschema.
"""
import json
import os
import subprocess
import sys
import xml.etree.ElementTree as xml

import h5py
import jsonschema
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

FRAMES = 7


def wave(n, frame, scale):
    return scale * np.sin(np.arange(n) + 10.0 * frame)


def expected(name, frame, count, components, kind):
    """What write_sample.cpp writes, or NaN where it reports nothing."""
    scale = {"velocity": 1, "contact_pressure": 1000, "stress": 1e5}[name]
    there = {"velocity": True, "contact_pressure": frame >= 2, "stress": frame != 3}[name]
    values = wave(count * components, frame, scale) if there else np.full(count * components, np.nan)
    return values.astype(kind).astype(float)


def check_grid(grid, file, frame, kind):
    """One frame as a VTK data set against the formulas and against the file."""
    n = int(file["VTKHDF/NumberOfPoints"][0])
    cells = int(file["VTKHDF/NumberOfCells"][0])
    assert grid.GetNumberOfPoints() == n and grid.GetNumberOfCells() == cells
    points = vtk_to_numpy(grid.GetPoints().GetData())
    rest = file["mortise/mesh/rest_points"][:]
    np.testing.assert_array_equal(points, (rest + [0, 0, 0.001 * frame]).astype(kind))
    np.testing.assert_array_equal(points, file["VTKHDF/Points"][frame * n:(frame + 1) * n])
    types = [grid.GetCellType(i) for i in range(cells)]
    np.testing.assert_array_equal(types, file["VTKHDF/Types"][:])
    offsets, connectivity = file["VTKHDF/Offsets"][:], file["VTKHDF/Connectivity"][:]
    for i in range(cells):
        ids = grid.GetCell(i).GetPointIds()
        got = [ids.GetId(k) for k in range(ids.GetNumberOfIds())]
        np.testing.assert_array_equal(got, connectivity[offsets[i]:offsets[i + 1]])
        if types[i] == vtk.VTK_QUADRATIC_TETRA:  # the last six nodes are where VTK expects them
            for e in range(6):
                a, b, middle = (points[grid.GetCell(i).GetEdge(e).GetPointId(k)].astype(float) for k in range(3))
                np.testing.assert_allclose(middle, (a + b) / 2, rtol=1e-6, atol=1e-9)
    for data, count, folder in ((grid.GetPointData(), n, "PointData"), (grid.GetCellData(), cells, "CellData")):
        names = {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())}
        assert names == set(file["VTKHDF/" + folder]), names
        for name in names:
            got = vtk_to_numpy(data.GetArray(name)).astype(float).ravel()
            stored = file[f"VTKHDF/{folder}/{name}"]
            if name == "body_id":
                np.testing.assert_array_equal(got, stored[:])
                continue
            components = stored.shape[1] if stored.ndim == 2 else 1
            np.testing.assert_allclose(got, expected(name, frame, count, components, kind), rtol=3e-7, atol=0)  # C's sin against numpy's
            np.testing.assert_array_equal(got, stored[frame * count:(frame + 1) * count].astype(float).ravel())


def read_with_hdf_reader(path, frames, kind):
    reader = vtk.vtkHDFReader()
    reader.SetFileName(path)
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == frames, reader.GetNumberOfSteps()
    times = list(reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()))
    np.testing.assert_array_equal(times, [0.05 * f for f in range(frames)])
    with h5py.File(path, "r") as file:
        # Forwards and in leaps: the reader may not rely on the order of frames.
        for frame in list(range(frames)) + [0, frames - 1, frames // 2]:
            reader.SetStep(frame)
            reader.UpdateTimeStep(times[frame])
            grid = reader.GetOutputDataObject(0)
            assert grid.IsA("vtkUnstructuredGrid"), grid.GetClassName()
            check_grid(grid, file, frame, kind)


def read_with_xdmf_reader(path, frames, kind):
    reader = vtk.vtkXdmfReader()
    reader.SetFileName(path.replace(".vtkhdf", ".xdmf"))
    reader.UpdateInformation()
    times = reader.GetOutputInformation(0).Get(vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    np.testing.assert_array_equal(times, [0.05 * f for f in range(frames)])
    with h5py.File(path, "r") as file:
        for frame in range(frames):
            reader.UpdateTimeStep(times[frame])
            grid = reader.GetOutputDataObject(0)
            while grid.IsA("vtkMultiBlockDataSet"):
                grid = grid.GetBlock(0)
            check_grid(grid, file, frame, kind)


def check_sidecar(path):
    """Every item of the sidecar lies within the dataset that it names."""
    tree = xml.parse(path.replace(".vtkhdf", ".xdmf"))
    with h5py.File(path, "r") as file:
        slabs = 0
        for item in tree.iter("DataItem"):
            if item.get("ItemType") == "HyperSlab":
                select, source = item.findall("DataItem")
                name, location = source.text.split(":")
                assert name == os.path.basename(path)
                shape = file[location].shape
                assert tuple(map(int, source.get("Dimensions").split())) == shape
                start, stride, count = np.array(select.text.split(), int).reshape(3, -1)
                assert (start + stride * count <= shape).all() and (stride == 1).all()
                slabs += 1
        assert slabs > 0


def check_conventions(path):
    with h5py.File(path, "r") as file:
        assert file.attrs["filetype"] == "mortise fields" and list(file.attrs["version"]) == [1, 0]
        for name in ("mortise_version", "git_sha1", "date_and_time", "scene_sha256"):
            assert isinstance(file.attrs[name], str) and file.attrs[name]
        assert file["mortise/scene"][()].decode().startswith("mortise: 1")
        assert file["VTKHDF"].attrs["Type"] == b"UnstructuredGrid"
        missing = []
        file.visititems(lambda name, object: missing.append(name)
                        if isinstance(object, h5py.Dataset) and "unit" not in object.attrs else None)
        assert not missing, missing
        ends = file["mortise/effects/barrier_contact/row_offset/gap"][:]
        np.testing.assert_array_equal(np.diff(ends), [f % 3 for f in range(FRAMES)])
        gap = file["mortise/effects/barrier_contact/gap"][:]
        for f in range(FRAMES):
            np.testing.assert_allclose(gap[ends[f]:ends[f + 1]], wave(f % 3, f, 1), rtol=3e-7)
        np.testing.assert_array_equal(file["mortise/effects/friction/work"][:], 0.5 * np.arange(FRAMES))
        np.testing.assert_array_equal(file["mortise/steps/step"][:], 1 + np.arange(FRAMES))


def check_run_json(work, schemas):
    with open(os.path.join(schemas, "run.schema.json")) as text:
        schema = json.load(text)
    jsonschema.Draft7Validator.check_schema(schema)
    validator = jsonschema.Draft7Validator(schema)
    for name, status in (("run.json", "done"), ("failed.json", "failed")):
        with open(os.path.join(work, name)) as text:
            record = json.load(text)
        validator.validate(record)
        assert record["status"] == status
        for key in record:  # nothing in it is optional
            assert not validator.is_valid({k: v for k, v in record.items() if k != key}), key
        assert not validator.is_valid({**record, "unheard_of": 1})


def main():
    writer, work, schemas = sys.argv[1:]
    os.makedirs(work, exist_ok=True)
    # Any complaint of VTK is a failure; it would otherwise go by on stderr.
    log = os.path.join(work, "vtk.log")
    if os.path.exists(log):
        os.remove(log)
    window = vtk.vtkFileOutputWindow()
    window.SetFileName(log)
    window.SetAppend(False)
    window.SetFlush(True)
    vtk.vtkOutputWindow.SetInstance(window)
    subprocess.run([writer, work], check=True)
    check_run_json(work, schemas)
    for name, frames, kind in (("mixed", FRAMES, np.float32), ("tets", FRAMES, np.float64), ("quadratic", FRAMES, np.float64), ("killed", 4, np.float32)):
        path = os.path.join(work, name + ".vtkhdf")
        read_with_hdf_reader(path, frames, kind)
        if name != "killed":
            check_conventions(path)
            check_sidecar(path)
    complaints = open(log).read() if os.path.exists(log) else ""
    assert not complaints, complaints
    # Only ParaView's XDMF reader regrets that a hyperslab cannot be cached.
    for name, kind in (("mixed", np.float32), ("tets", np.float64), ("quadratic", np.float64)):
        read_with_xdmf_reader(os.path.join(work, name + ".vtkhdf"), FRAMES, kind)
    print("read by VTK", vtk.vtkVersion().GetVTKVersion(), "and h5py", h5py.version.version)


if __name__ == "__main__":
    main()
