#!/usr/bin/env python3
"""Blender opens what `mortise export` writes: bodies where the run has them in every frame, materials, textures and texture coordinates, shape keys, cameras, colours of a field.

    blender.py MORTISE WORK_DIR

Needs h5py, numpy and pillow, and a Python that has Blender's module bpy (MORTISE_BPY=/path/to/python; `pip install bpy`) or `blender` in the path; without either it ends with code 77. Tried with bpy 4.2.0.
"""
import json
import os
import shutil
import subprocess
import sys

SCENE = """
mortise: 1
name: blender
time: {step: 5 ms, steps: 12, frame_every: 4}
materials:
  rubber: {youngs_modulus: 0.05 MPa, poisson_ratio: 0.4, density: 1000}
bodies:
  cube: {type: soft, shape: {box: {size: [40 mm, 40 mm, 40 mm], edge_length: 20 mm}}, material: rubber, position: [0, 0, 25 mm], velocity: [0, 0, -1]}
  slab: {type: stiff, mass: 0.1, shape: {box: {size: [30 mm, 20 mm, 10 mm], edge_length: 30 mm}}, position: [60 mm, 0, 40 mm], angular_velocity: [3, 5, 0],
         visual: {mesh: tile.obj, texture: tile.png, color: [1, 1, 1]}}
  floor: {type: half_space, visual: {color: [0.2, 0.3, 0.4]}}
effects:
  inertia: {}
  elasticity: {}
  affine_body: {}
  barrier_contact: {}
render:
  cameras:
    top: {position: [20 mm, 0, 300 mm], look_at: [20 mm, 0, 0], up: [0, 1, 0], fov: 40 deg}
    riding: {position: [60 mm, 0, 60 mm], look_at: [0, 0, 0], rides_on: slab}
"""
TILE = """v -0.015 -0.01 0.005
v 0.015 -0.01 0.005
v 0.015 0.01 0.005
v -0.015 0.01 0.005
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 2/2 3/3 4/4
"""


def inside(task):
    """In Blender: what it made of the files, as JSON."""
    import bpy

    out = {"version": bpy.app.version_string, "frames": []}

    def mesh_of(o, graph):
        m = o.evaluated_get(graph).to_mesh()
        p = [o.matrix_world @ v.co for v in m.vertices]
        colours = [tuple(c.color) for c in m.color_attributes[0].data] if m.color_attributes else []
        return {"points": [tuple(x) for x in p], "colours": colours}

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 24
    if task["file"].endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=task["file"], forward_axis="Y", up_axis="Z")
    else:
        bpy.ops.import_scene.gltf(filepath=task["file"])
    out["objects"] = {o.name: {"type": o.type, "keys": len(o.data.shape_keys.key_blocks) if o.type == "MESH" and o.data.shape_keys else 0,
                               "uv": [tuple(u.uv) for u in o.data.uv_layers[0].data] if o.type == "MESH" and o.data.uv_layers else [],
                               "materials": [m.name for m in o.data.materials] if o.type == "MESH" else [],
                               "children": [c.name for c in o.children],
                               "fov": o.data.angle_y if o.type == "CAMERA" else 0} for o in bpy.data.objects}
    out["materials"] = {}
    for m in bpy.data.materials:
        shader = next((n for n in m.node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None) if m.use_nodes else None
        colour = shader.inputs["Base Color"] if shader else None

        def behind(socket):
            if not socket.links:
                return []
            n = socket.links[0].from_node
            return [(n.type, n.image.size[0] if getattr(n, "image", None) else 0)] + [b for s in n.inputs for b in behind(s)]

        out["materials"][m.name] = {"colour": list(colour.default_value) if colour else [], "from": behind(colour) if colour else [],
                                    "roughness": shader.inputs["Roughness"].default_value if shader else -1}
    for f in task["blender_frames"]:
        bpy.context.scene.frame_set(f)
        graph = bpy.context.evaluated_depsgraph_get()
        shown = {o.name: mesh_of(o, graph) for o in bpy.data.objects if o.type == "MESH" and min(o.matrix_world.to_scale()) > 0.5}
        places = {o.name: tuple(o.matrix_world.translation) for o in bpy.data.objects if o.type == "CAMERA"}
        out["frames"].append({"meshes": shown, "cameras": places})
    json.dump(out, open(task["answer"], "w"))


def ask(file, frames):
    """Starts Blender on a file."""
    task = {"file": os.path.abspath(file), "blender_frames": frames, "answer": os.path.abspath("answer.json")}
    python, blender = os.environ.get("MORTISE_BPY"), shutil.which("blender")
    command = [python, __file__, "--inside", json.dumps(task)] if python else [blender, "-b", "--factory-startup", "--python", __file__, "--", "--inside", json.dumps(task)]
    if os.path.exists("answer.json"):
        os.remove("answer.json")
    done = subprocess.run(command, capture_output=True, text=True)
    assert os.path.exists("answer.json"), done.stdout + done.stderr
    return json.load(open("answer.json"))


def main():
    if not os.environ.get("MORTISE_BPY") and not shutil.which("blender"):
        print("there is no Blender here: neither MORTISE_BPY nor blender in the path")
        sys.exit(77)
    import h5py
    import numpy as np
    from PIL import Image

    mortise, work = sys.argv[1:]
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    os.chdir(work)
    open("scene.yaml", "w").write(SCENE)
    open("tile.obj", "w").write(TILE)
    Image.fromarray(np.random.default_rng(1).integers(0, 255, (8, 16, 3), dtype=np.uint8)).save("tile.png")

    def run(*command):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, (command, done.stderr)

    run(mortise, "run", "scene.yaml", "-o", "out", "-q", "--no-render")
    with h5py.File("out/fields.vtkhdf") as f:
        n, frames = int(f["VTKHDF/NumberOfPoints"][0]), int(f["VTKHDF/Steps"].attrs["NSteps"])
        points = f["VTKHDF/Points"][:frames * n].reshape(frames, n, 3).astype(float)
        bodies = f["VTKHDF/PointData/body_id"][:n]
        moved = np.linalg.norm(points - points[0], axis=2)
    box = lambda p: np.r_[np.min(p, axis=0), np.max(p, axis=0)]

    run(mortise, "export", "out", "-o", "a.glb", "--fps", "24")
    seen = ask("a.glb", list(range(frames)))
    objects = seen["objects"]
    assert objects["cube"]["keys"] == frames and objects["slab"]["keys"] == 0, objects
    assert objects["slab"]["materials"] == ["slab"] and ["TEX_IMAGE", 16] in seen["materials"]["slab"]["from"], seen["materials"]
    assert sorted(set(map(tuple, objects["slab"]["uv"]))) == [(0, 0), (0, 1), (1, 0), (1, 1)], objects["slab"]
    assert abs(objects["top"]["fov"] - np.deg2rad(40)) < 1e-5 and objects["riding"]["type"] == "CAMERA"
    srgb = np.array([0.2, 0.3, 0.4])
    assert np.allclose(seen["materials"]["floor"]["colour"][:3], ((srgb + 0.055) / 1.055) ** 2.4, atol=1e-4)
    for f in range(frames):
        got = seen["frames"][f]
        assert np.abs(box(got["meshes"]["cube"]["points"]) - box(points[f][bodies == 0])).max() < 1e-5, f
        assert np.allclose(got["cameras"]["top"], [0.02, 0, 0.3], atol=1e-6)
        # The tile is the upper face of the slab.
        corners = np.array(sorted(map(tuple, np.round(got["meshes"]["slab"]["points"], 5))))
        own = points[f][bodies == 1]
        assert all(np.linalg.norm(own - c, axis=1).min() < 2e-5 for c in corners), f
    assert np.linalg.norm(np.subtract(seen["frames"][3]["cameras"]["riding"], seen["frames"][0]["cameras"]["riding"])) > 1e-3

    run(mortise, "export", "out", "-o", "c.glb", "--fps", "24", "--colour-by", "displacement")
    seen = ask("c.glb", list(range(frames)))
    assert any(kind in ("VERTEX_COLOR", "ATTRIBUTE") for kind, size in seen["materials"]["cube"]["from"]) or not seen["materials"]["cube"]["from"], seen["materials"]["cube"]
    checked = 0
    for f in range(frames):
        shown = seen["frames"][f]["meshes"]
        pages = [name for name in shown if name.startswith("cube")]
        assert pages == [f"cube frame {f}"], (f, pages)
        page = shown[pages[0]]
        assert np.abs(box(page["points"]) - box(points[f][bodies == 0])).max() < 1e-5, f
        lightness = np.array(page["colours"])[:, :3].sum(axis=1)
        spread = np.ptp(moved[f][bodies == 0]) / moved.max()
        if spread < 1e-3:
            assert np.ptp(lightness) < 0.03, (f, np.ptp(lightness))
        elif spread > 0.05:  # what has moved most is brightest
            checked += 1
            brightest = np.array(page["points"])[lightness.argmax() % len(page["points"])] if len(lightness) == len(page["points"]) else None
            assert np.ptp(lightness) > 0.01
            if brightest is not None:
                nearest = np.linalg.norm(points[f][bodies == 0] - brightest, axis=1).argmin()
                assert moved[f][bodies == 0][nearest] > 0.98 * moved[f][bodies == 0].max()

    assert checked > 0
    run(mortise, "export", "out", "-o", "sequence/a.obj", "--every", "3", "--colour-by", "displacement")
    seen = ask("sequence/a_0003.obj", [0])
    shown = seen["frames"][0]["meshes"]
    assert set(shown) == {"cube", "slab"}, list(shown)
    assert np.abs(box(shown["cube"]["points"]) - box(points[3][bodies == 0])).max() < 1e-5
    mean = {name: np.array(shown[name]["colours"])[:, :3].mean(axis=0) for name in shown}
    assert np.abs(mean["slab"] - mean["cube"]).max() > 0.3, mean  # the cube is nearly where it was
    run(mortise, "export", "out", "-o", "plain/a.obj", "--every", "3")
    seen = ask("plain/a_0003.obj", [0])
    assert ["TEX_IMAGE", 16] in seen["materials"]["slab"]["from"] and seen["objects"]["slab"]["uv"], seen["materials"]
    print("opened by Blender", seen["version"])


if "--inside" in sys.argv:
    inside(json.loads(sys.argv[-1]))
else:
    main()
