#!/usr/bin/env python3
"""cycles.py PANWRIGHT FOLDER: time beside error of Blender's Cycles and of both engines, on one scene.

A spacecraft of boxes, Lambert, over a Lambert planet whose light is a part of the image's. Each program draws
it with growing numbers of samples. Error: RMSE of radiance, relative to the RMS of the long reference of the same program;
the last line holds how far the two long references are apart. Time: user and system, of all threads, of the process; that
with one sample (start, scene) stands apart. Needs Blender 3.4 or later with Cycles (Debian: blender); without, it says so.

Blender is asked for what is the same: a Sun of 1 W/m² and 0.53 degrees, pixels of even weight (box filter of 1 pixel), no
adaptive sampling, denoising, clamping or threshold of light, 8 bounces, single-precision EXR.
"""

import array
import csv
import math
import os
import resource
import shutil
import subprocess
import sys

SIZE = 96
FOV = 60.0
RADIUS = 637100.0  # a tenth of the Earth, so that Cycles' single precision holds it
AWAY = 677800.0
SUN = (1.0, -0.25, 0.6)
SUN_DEGREES = 0.53294
BOUNCES = 8
# size, centre, albedo
BOXES = [
    ((2.0, 2.0, 2.4), (0, 0, 0), 0.6),
    ((1.6, 4.5, 0.04), (0, 3.6, 0.2), 0.25),
    ((1.6, 4.5, 0.04), (0, -3.6, 0.2), 0.25),
    ((0.8, 0.8, 0.5), (0.3, 0.2, 1.45), 0.8),
    ((0.3, 0.3, 1.4), (-0.7, -0.6, -1.9), 0.5),
]
CAMERA, TARGET = (9.0, -7.0, 4.4), (0.0, -0.7, -0.6)

BLENDER = """
import bpy, math, sys, array
from mathutils import Vector
samples, out, threads = int(sys.argv[-3]), sys.argv[-2], int(sys.argv[-1])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
def material(albedo):
    made = bpy.data.materials.new("m")
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    lambert, end = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeOutputMaterial")
    lambert.inputs["Color"].default_value = (albedo, albedo, albedo, 1)
    made.node_tree.links.new(lambert.outputs[0], end.inputs["Surface"])
    return made
for size, centre, albedo in BOXES:
    bpy.ops.mesh.primitive_cube_add(size=1, location=centre, scale=size)
    bpy.context.object.data.materials.append(material(albedo))
bpy.ops.mesh.primitive_uv_sphere_add(segments=256, ring_count=128, radius=RADIUS, location=(0, 0, -AWAY))
bpy.ops.object.shade_smooth()
bpy.context.object.data.materials.append(material(0.3))
bpy.ops.object.light_add(type="SUN")
sun = bpy.context.object
sun.data.energy, sun.data.angle = 1.0, math.radians(SUN_DEGREES)
sun.rotation_mode = "QUATERNION"
sun.rotation_quaternion = Vector(SUN).to_track_quat("Z", "Y")
bpy.ops.object.camera_add(location=CAMERA)
camera = bpy.context.object
camera.rotation_mode = "QUATERNION"
camera.rotation_quaternion = (Vector(TARGET) - Vector(CAMERA)).to_track_quat("-Z", "Y")
camera.data.sensor_fit, camera.data.angle = "HORIZONTAL", math.radians(FOV)
camera.data.clip_end = 1e8
scene.camera = camera
scene.render.engine = "CYCLES"
scene.render.resolution_x = scene.render.resolution_y = SIZE
scene.render.resolution_percentage = 100
scene.render.threads_mode, scene.render.threads = "FIXED", threads
cycles = scene.cycles
cycles.device, cycles.samples = "CPU", samples
cycles.use_adaptive_sampling = cycles.use_denoising = False
cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0
cycles.light_sampling_threshold = cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0.0
cycles.max_bounces = cycles.diffuse_bounces = BOUNCES
scene.render.image_settings.file_format = "OPEN_EXR"
scene.render.image_settings.color_depth = "32"
scene.render.filepath = out + ".exr"
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(out + ".exr")
image.colorspace_settings.name = "Non-Color"
# rows from the bottom, RGBA
pixels = array.array("f", image.pixels[:])
with open(out, "wb") as file:
    for y in reversed(range(SIZE)):
        file.write(array.array("f", pixels[4 * SIZE * y : 4 * SIZE * (y + 1) : 4]).tobytes())
"""


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command[:3])}: {done.stdout[-2000:]}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def read_npy(path):
    with open(path, "rb") as file:
        data = file.read()
    start = 10 + int.from_bytes(data[8:10], "little")
    return array.array("f", data[start:])[::3]


class Cycles:
    name = f"Cycles, {BOUNCES} bounces"

    def __init__(self, folder):
        self.folder = folder
        names = ("SIZE", "FOV", "RADIUS", "AWAY", "SUN", "SUN_DEGREES", "BOUNCES", "BOXES", "CAMERA", "TARGET")
        self.script = os.path.join(folder, "scene.py")
        with open(self.script, "w", encoding="utf-8") as file:
            file.write("".join(f"{name} = {globals()[name]!r}\n" for name in names) + BLENDER)

    def draw(self, samples):
        out = os.path.join(self.folder, "cycles.bin")
        seconds = processor_seconds(["blender", "-b", "--factory-startup", "-t", "2", "--python-exit-code", "1",
                                     "--python", self.script, "--", str(samples), out, "2"])
        with open(out, "rb") as file:
            return array.array("f", file.read()), seconds


class Panwright:
    def __init__(self, name, program, folder, words):
        self.name, self.words, self.folder, self.program = name, words, folder, program
        self.model = os.path.join(folder, "craft.pxn")
        with open(self.model, "w", encoding="utf-8") as file:
            file.write('<pangu_model ver="1">\n')
            for i, (size, centre, albedo) in enumerate(BOXES):
                file.write(f'<material name="m{i}"><diffuse>{albedo} {albedo} {albedo}</diffuse></material>'
                           f'<box size="{" ".join(map(str, size))}" translate="{" ".join(map(str, centre))}" '
                           f'material="m{i}"/>\n')
            file.write("</pangu_model>\n")

    def draw(self, samples):
        out = os.path.join(self.folder, "own.npy")
        text = lambda v: " ".join(map(str, v))
        seconds = processor_seconds(
            [self.program, "render", self.model, "-o", out, "--size", str(SIZE), "--fov", str(FOV), "--camera", text(CAMERA),
             "--look-at", text(TARGET), "--sun", text(SUN), "--planet", f"ball=0 0 {-AWAY} radius={RADIUS} albedo=0.3",
             "--samples", str(math.isqrt(samples))] + self.words)
        return read_npy(out), seconds


def rmse(image, reference):
    square = sum(v * v for v in reference)
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(image, reference)) / square)


def main():
    program, folder = sys.argv[1:]
    if shutil.which("blender") is None:
        sys.exit("cycles.py: no blender (Debian: apt-get install blender)")
    os.makedirs(folder, exist_ok=True)
    reference = ["--engine", "reference", "--bounces", str(BOUNCES)]
    rows, longest = [], []
    for maker, counts, most in [
            (Cycles(folder), (4, 16, 64), 1024),
            (Panwright(f"reference engine, {BOUNCES} bounces", program, folder, reference), (4, 16, 64), 1024),
            (Panwright("OpenGL, light between surfaces, soft shadows", program, folder,
                       ["--indirect", "on", "--shadows", "soft"]), (1, 4, 16), 0)]:
        _, start = maker.draw(1)
        if most > 0:
            image, seconds = maker.draw(most)
            longest.append(image)
            rows.append([maker.name, most, f"{seconds:.2f}", f"{start:.2f}", ""])
            print(*rows[-1], sep=", ", flush=True)
        for samples in counts:
            image, seconds = maker.draw(samples)
            rows.append([maker.name, samples, f"{seconds:.2f}", f"{start:.2f}", f"{rmse(image, longest[-1]):.2e}"])
            print(*rows[-1], sep=", ", flush=True)
    rows.append(["the two long references", 1024, "", "", f"{rmse(longest[0], longest[1]):.2e}"])
    print(*rows[-1], sep=", ")
    with open(os.path.join(folder, "cycles.csv"), "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["program", "samples a pixel", "s of processors", "of these with one sample", "RMSE over RMS"])
        out.writerows(rows)


if __name__ == "__main__":
    main()
