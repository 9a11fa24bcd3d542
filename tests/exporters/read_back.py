#!/usr/bin/env python3
"""Runs a scene, and reads what cameras and `mortise export` wrote with programs that share nothing with it: Pillow the images, VTK the glTF and OBJ files, h5py the
positions that they have to show.

    read_back.py MORTISE WORK_DIR

Needs vtk, h5py, numpy and pillow.
"""
import glob
import json
import os
import shutil
import subprocess
import sys

import h5py
import numpy as np
import vtk
from PIL import Image
from vtk.util.numpy_support import vtk_to_numpy

SCENE = """
mortise: 1
name: readback
time: {step: 5 ms, steps: 12, frame_every: 4}
materials:
  rubber: {youngs_modulus: 0.05 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  cube: {type: soft, shape: {box: {size: [40 mm, 40 mm, 40 mm], edge_length: 20 mm}}, material: rubber, position: [0, 0, 25 mm], velocity: [0, 0, -1]}
  slab: {type: stiff, mass: 0.1, shape: {box: {size: [30 mm, 20 mm, 10 mm], edge_length: 30 mm}}, position: [60 mm, 0, 40 mm], angular_velocity: [3, 5, 0]}
  floor: {type: half_space}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  barrier_contact: {}
render:
  width: 160
  height: 120
  cameras:
    top: {position: [20 mm, 0, 300 mm], look_at: [20 mm, 0, 0], up: [0, 1, 0], fov: 40 deg, outputs: [color, depth, depth_float, segmentation], depth_unit: 0.1 mm}
    eye: {position: [20 mm, 0, 100 mm], look_at: [20 mm, 0, 0], up: [0, 1, 0], model: fisheye, fov: 170 deg, outputs: [depth, segmentation], rides_on: slab}
"""


def run(*command, code=0):
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == code, (command, done.returncode, done.stderr)
    return done


def check_images(frames, points, bodies):
    """Every frame of `top`: depth of what lies under a pixel, by the written intrinsics and pose; the body there."""
    assert not glob.glob(frames + "/eye_0*.png"), "eye writes no colour"
    for f in range(4):
        camera = json.load(open(f"{frames}/top_{f:04}.json"))
        colour, depth, label = (Image.open(f"{frames}/{camera[k]['file']}") for k in ("color", "depth", "segmentation"))
        assert colour.mode == "RGB" and depth.mode == "I;16" and label.mode == "P", (colour.mode, depth.mode, label.mode)
        assert colour.size == depth.size == label.size == (camera["width"], camera["height"])
        metres = np.load(f"{frames}/{camera['depth_float']['file']}")
        assert metres.dtype == np.float32 and metres.shape == (camera["height"], camera["width"]) and camera["depth_float"]["unit_m"] == 1
        assert np.array_equal(np.isfinite(metres), np.asarray(label) > 0)
        assert np.abs(np.where(np.isfinite(metres), metres, 0) - np.asarray(depth) * camera["depth"]["unit_m"]).max() < 0.051e-3, "to half a count"
        z, ids = np.asarray(depth) * camera["depth"]["unit_m"], np.asarray(label)
        table = {b["name"]: b for b in camera["segmentation"]["bodies"]}
        assert [table[n]["id"] for n in ("cube", "slab", "floor")] == [1, 2, 3]
        palette = np.array(label.getpalette()).reshape(-1, 3)
        for b in table.values():
            assert list(palette[b["id"]]) == b["color"], b
        pose = np.array(camera["camera_to_world"])
        assert np.allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3), atol=1e-12) and np.isclose(np.linalg.det(pose[:3, :3]), 1)
        v, u = np.mgrid[0:camera["height"], 0:camera["width"]]
        local = np.stack([(u - camera["cx"]) / camera["fx"] * z, (v - camera["cy"]) / camera["fy"] * z, z], axis=-1)
        world = local @ pose[:3, :3].T + pose[:3, 3]
        assert np.abs(world[ids == 3][:, 2]).max() < 0.06e-3, "the floor is where it is, to half a count"
        for body, name in enumerate(("cube", "slab")):
            seen, own = world[ids == body + 1], points[f][bodies == body]
            assert len(seen) > 100, (name, len(seen))
            assert (seen > own.min(axis=0) - 0.2e-3).all() and (seen < own.max(axis=0) + 0.2e-3).all(), name
            assert seen[:, 2].max() > own[:, 2].max() - 2e-3, name
    # The fisheye rides: it sees the floor at its height over it, along the ray that goes straight down.
    for f in range(4):
        camera = json.load(open(f"{frames}/eye_{f:04}.json"))
        assert camera["distortion_model"] == "equidistant" and camera["rides_on"] == "slab" and "color" not in camera
        ranges = np.asarray(Image.open(f"{frames}/{camera['depth']['file']}")) * camera["depth"]["unit_m"]
        ids = np.asarray(Image.open(f"{frames}/{camera['segmentation']['file']}"))
        pose = np.array(camera["camera_to_world"])
        v, u = np.mgrid[0:camera["height"], 0:camera["width"]]
        x, y = (u - camera["cx"]) / camera["fx"], (v - camera["cy"]) / camera["fy"]
        theta = np.hypot(x, y)
        rays = np.stack([np.sinc(theta / np.pi) * x, np.sinc(theta / np.pi) * y, np.cos(theta)], axis=-1)
        world = ranges[..., None] * (rays @ pose[:3, :3].T) + pose[:3, 3]
        floor = (ids == 3) & (ranges > 0)
        assert floor.sum() > 500
        assert np.abs(world[floor][:, 2]).max() < 0.6e-3, "to half a count of 1 mm"
        assert (ids[(camera["width"] - 160) // 2, 0] == 0), "outside the image circle nothing is seen"


def blocks(data):
    """Points of every polygonal piece in a tree of VTK blocks."""
    if isinstance(data, vtk.vtkMultiBlockDataSet):
        for k in range(data.GetNumberOfBlocks()):
            yield from blocks(data.GetBlock(k))
    elif data is not None and data.GetNumberOfPoints() > 0:
        yield vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def check_gltf(path, points, bodies, times):
    reader = vtk.vtkGLTFReader()
    reader.SetFileName(path)
    reader.SetApplyDeformationsToGeometry(True)
    reader.UpdateInformation()
    assert reader.GetNumberOfAnimations() == 1
    reader.EnableAnimation(0)
    reader.SetFrameRate(60)
    for f, t in enumerate(times):
        reader.UpdateTimeStep(t - times[0])
        pieces = [p[:, [0, 2, 1]] * [1, -1, 1] for p in blocks(reader.GetOutput())]  # y up -> z up
        for body in (0, 1):
            own = points[f][bodies == body]
            distance = min(np.abs(np.r_[p.min(axis=0), p.max(axis=0)] - np.r_[own.min(axis=0), own.max(axis=0)]).max() for p in pieces)
            assert distance < 1e-5, (f, body, distance)


def check_obj(path, points):
    reader = vtk.vtkOBJReader()
    reader.SetFileName(path)
    reader.Update()
    got = vtk_to_numpy(reader.GetOutput().GetPoints().GetData())
    assert np.allclose([got.min(axis=0), got.max(axis=0)], [points.min(axis=0), points.max(axis=0)], atol=1e-6)


def main():
    mortise, work = sys.argv[1:]
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    os.chdir(work)
    open("scene.yaml", "w").write(SCENE)
    run(mortise, "run", "scene.yaml", "-o", "out", "-q")
    with h5py.File("out/fields.vtkhdf") as f:
        n, frames = int(f["VTKHDF/NumberOfPoints"][0]), int(f["VTKHDF/Steps"].attrs["NSteps"])
        points = f["VTKHDF/Points"][:frames * n].reshape(frames, n, 3).astype(float)
        bodies, times = f["VTKHDF/PointData/body_id"][:n], f["VTKHDF/Steps/Values"][:frames]
    assert frames == 4 and np.abs(points[3] - points[0]).max() > 5e-3
    check_images("out/frames", points, bodies)
    before = {p: open(p, "rb").read() for p in glob.glob("out/frames/*")}
    run(mortise, "render", "scene.yaml", "out/fields.vtkhdf", "-o", "again")
    for p, content in before.items():
        again = open("again/" + os.path.basename(p), "rb").read()
        if "eye" in p or "top_depth" in p or p.endswith(".json"):
            continue  # positions went through single precision
        assert again == content, p
    run(mortise, "export", "out", "-o", "a.glb")
    check_gltf("a.glb", points, bodies, times)
    run(mortise, "export", "out/fields.vtkhdf", "-o", "sequence/a.obj", "--every", "3")
    assert sorted(os.listdir("sequence")) == ["a.mtl", "a_0000.obj", "a_0003.obj"]
    check_obj("sequence/a_0003.obj", points[3])
    assert "exists already" in run(mortise, "export", "out", "-o", "a.glb", code=2).stderr
    run(mortise, "export", "out", "-o", "a.glb", "--overwrite", "--frames", "2:", "--fps", "24")
    # What a run wrote it removes again, and nothing else.
    open("out/frames/mine.json", "w").write("{}")
    run(mortise, "run", "scene.yaml", "-o", "out", "-q", "--overwrite", "--no-render")
    assert os.listdir("out/frames") == ["mine.json"], os.listdir("out/frames")
    print("images, glTF and OBJ read back")


main()
