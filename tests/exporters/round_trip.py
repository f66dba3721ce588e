#!/usr/bin/env python3
"""glTF → pan → glTF: the exported file looks as the original does, to a renderer that shares nothing
with the project (gltf_viewer.py).

    round_trip.py PANWRIGHT generated
    round_trip.py PANWRIGHT corpus FOLDER
"""
import json
import os
import struct
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("skipped: needs numpy")
    sys.exit(77)

sys.dont_write_bytecode = True
import gltf_viewer as viewer

# ---- generated models


def texture(side, seed, low, high):
    """Codes that change over a few texels: RGBA, A 255."""
    rng = np.random.default_rng(seed)
    coarse = rng.integers(low, high, (side // 4, side // 4, 3)).astype(np.uint8)
    return np.repeat(np.repeat(coarse, 4, 0), 4, 1)


def holes(side):
    y, x = np.mgrid[0:side, 0:side]
    rgba = np.full((side, side, 4), 200, np.uint8)
    rgba[..., 3] = np.where((x // 6 + y // 6) % 2 == 0, 255, 40)
    return rgba


def png_file(codes):
    channels = codes.shape[2]
    raw = b"".join(b"\0" + codes[y].tobytes() for y in range(codes.shape[0]))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", viewer.zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", codes.shape[1], codes.shape[0], 8, 2 if channels == 3 else 6, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", viewer.zlib.compress(raw)) +
            chunk(b"IEND", b""))


def bowl(share, colors):
    """A sphere from its top to a share of the way down; 1: closed."""
    rings, turns = 16, 32
    v, u = np.mgrid[0:rings + 1, 0:turns + 1]
    polar, turn = v / rings * np.pi * share, u / turns * 2 * np.pi
    points = np.stack([np.sin(polar) * np.cos(turn), np.cos(polar), np.sin(polar) * np.sin(turn)], -1)
    uv = np.stack([u / turns, v / rings], -1)
    corners = []
    for j in range(rings):
        for i in range(turns):
            a = j * (turns + 1) + i
            b = a + turns + 1
            if j > 0:
                corners.append([a, a + 1, b])
            if j < rings - 1 or share < 1:
                corners.append([a + 1, b + 1, b])
    out = {"POSITION": points.reshape(-1, 3), "NORMAL": points.reshape(-1, 3), "TEXCOORD_0": uv.reshape(-1, 2)}
    if colors:
        out["COLOR_0"] = 0.25 + 0.75 * np.abs(points.reshape(-1, 3))
    return out, np.array(corners)


def write_model(path, material, images, share=1, colors=False, used=()):
    data, views, accessors = b"", [], []

    def add(content):
        nonlocal data
        data += b"\0" * (-len(data) % 4)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(content)})
        data += content
        return len(views) - 1

    def accessor(array, kind, number):
        made = {"bufferView": add(array.tobytes()), "componentType": number, "count": len(array), "type": kind}
        if kind == "VEC3":
            made["min"], made["max"] = array.min(0).tolist(), array.max(0).tolist()
        accessors.append(made)
        return len(accessors) - 1

    arrays, corners = bowl(share, colors)
    attributes = {name: accessor(a.astype(np.float32), f"VEC{a.shape[1]}", 5126) for name, a in arrays.items()}
    indices = accessor(corners.astype(np.uint32).reshape(-1, 1), "SCALAR", 5125)
    root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]}],
            "materials": [dict(material, name="m")]}
    if images:
        root["images"] = [{"bufferView": add(png_file(i)), "mimeType": "image/png"} for i in images]
        root["textures"] = [{"source": i} for i in range(len(images))]
    if used:
        root["extensionsUsed"] = list(used)
    root.update(bufferViews=views, accessors=accessors, buffers=[{"byteLength": len(data)}])
    text = json.dumps(root).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) +
                   struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


BASE, METAL, BUMPS = texture(32, 1, 20, 250), texture(32, 2, 0, 256), texture(32, 3, 100, 156)
BUMPS[..., 2] = 250


def pbr(**values):
    return {"pbrMetallicRoughness": values}


def textures(base=None, metal=None):
    out = {}
    if base is not None:
        out["baseColorTexture"] = {"index": base}
    if metal is not None:
        out["metallicRoughnessTexture"] = {"index": metal}
    return out


TWICE = {"KHR_texture_transform": {"scale": [2, 3], "offset": [0.25, -0.5]}}

# name, arguments of write_model, and what the viewer may find: mean and p99, about twice what was
# measured: 0.0023 0.0154, 0.0154 0.1654, 0.0045 0.0141, 0, 0.0014 0.0024, 0, 0, 0, 0.0009 0.0110,
# 0.0013 0.0017, 0, 0, 0, 0, 0.0019 0.0129, 0.0015 0.0062, 0.0027 0.0113. What is there are 8-bit codes of
# reflectances and slopes in the pan.
GENERATED = [
    ("mixture", dict(material={**pbr(**textures(0, 1)), "normalTexture": {"index": 2}},
                     images=[BASE, METAL, BUMPS]), 0.004, 0.03),
    # the smaller texture is sampled between its texels, and loses its corners
    ("mixture-sizes", dict(material=pbr(**textures(0, 1)), images=[BASE, texture(16, 5, 0, 256)]), 0.02, 0.25),
    ("mixture-factors", dict(material=pbr(baseColorFactor=[0.9, 0.5, 0.3, 1], metallicFactor=0.8,
                                          roughnessFactor=0.7, **textures(0, 1)), images=[BASE, METAL]), 0.008, 0.03),
    ("half-metal", dict(material=pbr(baseColorFactor=[0.9, 0.5, 0.3, 1], metallicFactor=0.5, roughnessFactor=0.4),
                        images=[]), 1e-3, 2e-3),
    ("half-metal-colors", dict(material=pbr(metallicFactor=0.5, roughnessFactor=0.4, **textures(0)),
                               images=[BASE]), 0.003, 0.005),
    ("metal", dict(material=pbr(metallicFactor=1, roughnessFactor=0.5, **textures(0)), images=[BASE]), 1e-3, 2e-3),
    ("dielectric", dict(material=pbr(metallicFactor=0, roughnessFactor=0.3, **textures(0)), images=[BASE]),
     1e-3, 2e-3),
    ("holes", dict(material={**pbr(metallicFactor=0, roughnessFactor=0.6, **textures(0)), "alphaMode": "MASK",
                             "alphaCutoff": 0.4, "doubleSided": True}, images=[holes(36)], share=0.6), 1e-3, 2e-3),
    ("holes-metal", dict(material={**pbr(**textures(0, 1)), "alphaMode": "MASK", "alphaCutoff": 0.4,
                                   "doubleSided": True}, images=[holes(32), METAL], share=0.6), 0.002, 0.02),
    ("open", dict(material={**pbr(metallicFactor=0.5, **textures(0)), "doubleSided": True}, images=[BASE], share=0.5),
     0.003, 0.005),
    ("specular", dict(material={**pbr(metallicFactor=0, roughnessFactor=0.4, **textures(0)),
                                "extensions": {"KHR_materials_specular": {"specularFactor": 0.6},
                                               "KHR_materials_ior": {"ior": 1.8}}}, images=[BASE],
                      used=("KHR_materials_specular", "KHR_materials_ior")), 1e-3, 2e-3),
    ("specular-color", dict(material={**pbr(metallicFactor=0, roughnessFactor=0.4),
                                      "extensions": {"KHR_materials_specular": {"specularColorFactor": [1, 0.5, 2]}}},
                            images=[], used=("KHR_materials_specular",)), 1e-3, 2e-3),
    ("glow", dict(material={**pbr(metallicFactor=0, roughnessFactor=0.8, baseColorFactor=[0.1, 0.1, 0.1, 1]),
                            "emissiveFactor": [0.2, 0.1, 0.05],
                            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 3}}}, images=[],
                  used=("KHR_materials_emissive_strength",)), 1e-3, 2e-3),
    ("colors", dict(material=pbr(metallicFactor=0, roughnessFactor=0.5, **textures(0)), images=[BASE], colors=True),
     1e-3, 2e-3),
    ("repeated", dict(material=pbr(baseColorTexture={"index": 0, "extensions": TWICE},
                                   metallicRoughnessTexture={"index": 1, "extensions": TWICE}),
                      images=[BASE, METAL], used=("KHR_texture_transform",)), 0.004, 0.03),
    ("bumps-scaled", dict(material={**pbr(metallicFactor=0, roughnessFactor=0.5),
                                    "normalTexture": {"index": 0, "scale": 0.6}}, images=[BUMPS]), 0.003, 0.015),
    ("coat", dict(material={**pbr(metallicFactor=0, roughnessFactor=0.6, **textures(0)),
                            "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 1,
                                                                       "clearcoatRoughnessFactor": 0.3}}},
                  images=[BASE], used=("KHR_materials_clearcoat",)), 0.005, 0.025),
]

# ---- public models, as they come with the corpus. The bounds: 0.02 and 0.05.

CORPUS = [
    "gltf-hard/khronos/NormalTangentTest/NormalTangentTest.glb",
    "gltf-hard/blender-io/01_alpha_mask/01_alpha_mask.gltf",
    "gltf-hard/blender-io/12_orm_two_uvmaps/12_orm_two_uvmaps.gltf",
    "gltf-hard/draco/sphere_lights.gltf",
    "gltf-hard/cesium-native/BoxTexturedWebp.gltf",
    "spacecraft-gltf/hubble-sketchfab-ccby.glb",
    "spacecraft-gltf/m2020-rover/Wheel_LeftFront.gltf",
    "spacecraft-gltf/ace-draco-webp.glb",
    "spacecraft-gltf/sentinel6-draco-webp.glb",
    "spacecraft-gltf/dscovr-draco-webp.glb",
    "spacecraft-gltf/ulysses-draco-webp.glb",
    "spacecraft-gltf/juno-draco-webp.glb",
]


def exported(program, source, target):
    run = subprocess.run([program, "export", source, "-o", target, "--crease", "0", "--units", "m", "--keep-hidden",
                          "-q"], capture_output=True, text=True)
    if not os.path.exists(target):
        sys.exit(f"{source}: nothing was exported\n{run.stderr}")


def check(name, program, source, folder, mean, p99, size, **options):
    target = os.path.join(folder, "exported.glb")
    if os.path.exists(target):
        os.remove(target)
    exported(program, source, target)
    try:
        found = viewer.compared(source, target, size=size, **options)
    except viewer.Unreadable as problem:
        print(f"{name:18s} skipped: needs {problem}")
        return None
    good = found["mean"] <= mean and found["p99"] <= p99 and found["missing"] <= 1e-3
    print(f"{name:18s} mean {found['mean']:.5f} p99 {found['p99']:.4f} brightness {found['brightness']:.4f} "
          f"missing {found['missing']:.4f}{'' if good else '  FAILED'}", flush=True)
    return good


def main():
    program, kind = sys.argv[1], sys.argv[2]
    results = []
    with tempfile.TemporaryDirectory() as folder:
        if kind == "generated":
            for name, arguments, mean, p99 in GENERATED:
                source = os.path.join(folder, f"{name}.glb")
                write_model(source, **arguments)
                results.append(check(name, program, source, folder, mean, p99, 96))
            # the viewer tells different materials apart
            others = viewer.compared(os.path.join(folder, "mixture.glb"), os.path.join(folder, "dielectric.glb"), 96)
            if others["mean"] < 0.1:
                print("the viewer takes different materials for the same")
                results.append(False)
        else:
            corpus = os.environ.get("PANWRIGHT_CORPUS", sys.argv[3])
            if not os.path.isdir(corpus):
                print("skipped: the corpus is not here")
                sys.exit(77)
            for path in CORPUS:
                # emission by textures is lost on import, and said
                results.append(check(os.path.basename(path)[:18], program, os.path.join(corpus, path), folder,
                                     0.02, 0.05, 128, emission=False))
            if sum(r is not None for r in results) < 4:
                sys.exit("fewer than four models could be read")
    sys.exit(0 if all(r is not False for r in results) else 1)


if __name__ == "__main__":
    main()
