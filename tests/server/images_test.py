#!/usr/bin/env python3
"""Images of the server beside those that `render` makes of the same state, pixel for pixel. images_test.py PANWRIGHT SOURCE_DIR

Light of the camera, colours and stars of the sky, moving cameras, and all formats of bytes. Expected values follow from files of
`render` and from formulas of the documentation, computed here.
"""

import atexit
import json
import math
import os
import struct
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError as missing:
    print(missing)
    sys.exit(77)

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
sys.path.insert(0, os.path.join(SOURCE, "server", "clients"))
from panwright_client import Client, pack_double, pack_float  # noqa: E402

WIDTH, HEIGHT = 48, 32
COMMON = ["--size", f"{WIDTH}x{HEIGHT}", "--fov", "40", "--sun", "1 -2 2", "--gl", "auto"]
REFERENCE = ["--engine", "reference", "--samples", "2"]
OPENGL = ["--engine", "gl", "--samples", "3", "--shadows", "hard"]
VIEW = {"camera": [0.3, -7, 0.5], "quat": [math.sqrt(0.5), -math.sqrt(0.5), 0, 0]}
SCENE = """<pangu_model ver="1" units="m">
  <material name="ochre"><diffuse>0.8 0.5 0.2</diffuse></material>
  <material name="blue"><diffuse>0.2 0.4 0.9</diffuse></material>
  <node name="slab" material="ochre"><box size="2 1 1.5"/></node>
  <node name="ball" material="blue"><sphere radius="0.6" translate="1.2 -0.6 0.9"/></node>
</pangu_model>
"""


def expect(condition, what):
    if not condition:
        raise SystemExit(f"images_test: {what}")


def word(*values):
    return struct.pack(f">{len(values)}I", *values)


def f(*values):
    return b"".join(map(pack_float, values))


def d(*values):
    return b"".join(map(pack_double, values))


class Server:
    """A server of the scene, a client of it, and its images as arrays from the top row."""

    def __init__(self, engine, *options):
        self.process = subprocess.Popen([PROGRAM, "serve", "craft.pxn", *COMMON, *engine, "--port", "0", *options], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError(self.process.stderr.read())
        self.client = Client(port=int(line.rsplit(":", 1)[1]))
        self.client.set_viewpoint(VIEW["camera"], VIEW["quat"])

    def __enter__(self):
        return self

    def __exit__(self, kind=None, *_):
        if kind is not None:
            return
        self.client.close()
        self.process.terminate()
        expect(self.process.wait(20) == 0, "the server ends cleanly")

    def set(self, number, *fields):
        self.client._send(number, *fields)
        self.client._expect(0)

    def radiance(self):
        """Of --format float."""
        magic, size, scale, data = self.client.image().split(b"\n", 3)
        channels = {b"PF": 3, b"Pf": 1}[magic]
        expect(size == b"%d %d" % (WIDTH, HEIGHT) and scale == b"-1.0", (size, scale))
        return np.frombuffer(data, "<f4").reshape(HEIGHT, WIDTH, channels)[::-1]


def rendered(engine, views, *options):
    """Radiance and coverage of views."""
    for k, view in enumerate(views):
        view["output"] = f"{k}.npz"
    with open("views.json", "w", encoding="utf-8") as file:
        json.dump(views, file)
    done = subprocess.run([PROGRAM, "render", "craft.pxn", *COMMON, *engine, "--views", "views.json", *options], capture_output=True, text=True)
    expect(done.returncode == 0, done.stderr)
    return [(file["radiance"], file["coverage"].reshape(HEIGHT, WIDTH, 1)) for file in (np.load(view["output"]) for view in views)]


def same(got, expected, what, tolerance=0.0):
    """Largest difference in parts of the brightest pixel."""
    expect(expected.max() > 0, f"{what}: the expected image is black")
    error = np.abs(got - expected).max() / expected.max()
    expect(error <= tolerance, f"{what}: differs by {error:.3g} of the brightest pixel, expected at most {tolerance:.3g}")


def lights(engine):
    """SetSunColour, SetAmbientLight, BindLightToCamera, ConfigureLight, SetLightPositionDirection."""
    at, axis = (0.3, -0.2, 0.1), (-0.05, 0.02, 1)
    spot = "spot on camera at 0.3 -0.2 0.1 toward 0.25 -0.18 1.1 intensity 30 20 10 half-angle 8deg exponent 3"
    with Server(engine, "--format", "float") as server:
        plain = rendered(engine, [dict(VIEW)])[0][0]
        same(server.radiance(), plain, "as it is")
        server.set(290, word(0), f(30, 20, 10, 8, 3), bytes(40))
        server.set(292, word(0), d(*at, *axis))
        same(server.radiance(), plain, "a light that is off")
        server.set(289, word(0, 0), b"\1")
        lit = rendered(engine, [dict(VIEW, lamp=[spot])])[0][0]
        expect(np.abs(lit - plain).max() > 0.1 * plain.max(), "the light is seen")
        # the axis is normalised: measured 0 (reference) and 0 (OpenGL)
        same(server.radiance(), lit, "a spot", 1e-6)
        server.set(291, word(0), f(5, 5, 5, math.pi, 0), bytes(40))
        point = rendered(engine, [dict(VIEW, lamp=["point on camera at 0.3 -0.2 0.1 intensity 5"])])[0][0]
        same(server.radiance(), point, "a point")
        server.set(289, word(0, 0), b"\0")
        same(server.radiance(), plain, "a light that is off again")
        server.set(259, f(0.5, 0.25, 2))
        same(server.radiance(), plain * np.float32([0.5, 0.25, 2]), "the Sun's colour", 1e-6)
        server.set(259, f(1, 1, 1))
        server.set(280, d(149597870700.0, 0.4, -0.3))
        turned = [math.cos(-0.3) * math.cos(0.4), math.cos(-0.3) * math.sin(0.4), math.sin(-0.3)]
        same(server.radiance(), rendered(engine, [dict(VIEW, sun=turned)])[0][0], "the Sun elsewhere", 1e-6)


def skies(engine):
    """SetSkyType, SetSkyRGB, SetSkyCIE: sky / pi where nothing covers, stars as --stars has them."""
    with Server(engine, "--format", "float") as server:
        plain, coverage = rendered(engine, [dict(VIEW)])[0]
        expect(0.05 < coverage.mean() < 0.9 and ((coverage > 0) & (coverage < 1)).any(), "a part of the image is covered")
        server.set(282, f(0.1, 0.2, 0.4))
        server.set(283, f(0.3127, 0.3290, 0.5))  # white D65, of half the luminance
        for kind, color, tolerance in ((3, (1, 0, 0), 1e-6), (4, (0, 1, 0), 1e-6), (5, (0, 0, 1), 1e-6), (6, (1, 1, 1), 1e-6),
                                       (8, (0.1, 0.2, 0.4), 1e-6), (9, (0.5, 0.5, 0.5), 2e-4), (0, (0, 0, 0), 0.0)):
            server.set(260, word(kind))
            # of 9: the matrix of IEC 61966-2-1 has four digits
            same(server.radiance(), plain + (1 - coverage) * np.array(color) / math.pi, f"sky {kind}", tolerance)
        stars = rendered(engine, [dict(VIEW, stars=8, psf=0.6)])[0][0]
        expect((stars[coverage[:, :, 0] == 0] > 0).any(), "there are stars")
    with Server(engine, "--format", "float", "--psf", "0.6") as server:
        server.set(260, word(2))
        same(server.radiance(), stars, "stars", 1e-6)


def turned_by(quaternion, vector):
    """q exp(v), of a rotation vector."""
    angle = math.sqrt(sum(x * x for x in vector))
    s = math.sin(angle / 2) / angle if angle > 0 else 0
    w, x, y, z = quaternion
    a, (b, c, e) = math.cos(angle / 2), (s * x for x in vector)
    return [w * a - x * b - y * c - z * e, w * b + x * a + y * e - z * c, w * c - x * e + y * a + z * b, w * e + x * c - y * b + z * a]


def moved(rates, time):
    """The view at a time: position, velocity, acceleration and jerk, and the same of the attitude."""
    weights = time, time ** 2 / 2, time ** 3 / 6
    linear, angular = rates[0::2], rates[1::2]
    step = [sum(w * row[k] for w, row in zip(weights, linear)) for k in range(3)]
    turn = [sum(w * row[k] for w, row in zip(weights, angular)) for k in range(3)]
    return {"camera": [p + s for p, s in zip(VIEW["camera"], step)], "quat": turned_by(VIEW["quat"], turn)}


def motion(engine):
    """SetCameraMotion: the mean of images at moments that divide the exposure."""
    exposure = 0.5
    rates = [(0.4, 0.2, 0.1), (0.02, -0.05, 0.3), (0.5, 0, -0.4), (0, 0.1, 0.2), (1, 0, 0.5), (0, 0, 0.4)]
    with Server(engine, "--format", "float", "--exposure", str(exposure)) as server:
        still = server.radiance()
        same(still, rendered(engine, [dict(VIEW)])[0][0], "a camera at rest")
        server.set(299, word(0), d(*(number for row in rates for number in row)))
        got = server.radiance()
        expect(np.abs(got - still).max() > 0.1 * still.max(), "the motion is seen")
        errors = {}
        for count in range(3, 24, 2):  # an odd number, not told: the one that fits
            views = [moved(rates, exposure * ((k + 0.5) / count - 0.5)) for k in range(count)]
            mean = np.mean([np.float64(image) for image, _ in rendered(engine, views)], axis=0)
            errors[count] = np.abs(got - mean).max() / mean.max()
        best = min(errors, key=errors.get)
        # measured 1e-7, and 0.03 or more of the other numbers
        expect(errors[best] < 1e-6 and sorted(errors.values())[1] > 1e-3, f"moments of a moving camera: {errors}")
        server.set(299, word(0), d(*[0] * 18))
        same(server.radiance(), still, "a camera at rest again")


def formats(engine):
    """Bytes of ppm and raw: 255 pi L / E 2^EV, clipped; of float: PFM; of each in grey: the mean of the bands."""
    light = ["--sun-irradiance", "2 1 1.5", "--ev", "0.5"]
    radiance = rendered(engine, [dict(VIEW)], *light)[0][0]
    for grey in (False, True):
        values = radiance.mean(axis=2, keepdims=True, dtype=np.float32) if grey else radiance
        scaled = np.clip(np.float64(values) * math.pi * 2 ** 0.5 / 2, 0, 1) * 255
        expect((scaled == 255).any() == False and scaled.max() > 100, "levels of the image")  # noqa: E712
        for name in ("ppm", "raw", "float"):
            with Server(engine, "--format", name, *light, *(["--grey"] if grey else [])) as server:
                if name == "float":
                    same(server.radiance(), values, f"float, grey {grey}", 1e-7 if grey else 0.0)
                    continue
                data = server.client.image()
                header = b"" if name == "raw" else b"P%d\n%d %d\n255\n" % (5 if grey else 6, WIDTH, HEIGHT)
                expect(data.startswith(header) and len(data) == len(header) + values.size, f"{name}: {len(data)} bytes")
                numbers = np.frombuffer(data[len(header):], np.uint8).reshape(values.shape)
                # half a level, and rounding of float32
                expect(np.abs(numbers - scaled).max() <= 0.5 + 1e-3, f"{name}, grey {grey}: {np.abs(numbers - scaled).max()}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("craft.pxn", "w", encoding="utf-8") as file:
            file.write(SCENE)
        for check in (lights, skies, formats):
            check(REFERENCE)
        try:
            Server(OPENGL).__exit__()
        except RuntimeError as error:
            expect("E5007" in str(error) or "E5001" in str(error), error)
            print("without OpenGL: moving cameras are not tested, lights and skies by the reference alone")
            os.chdir("/")
            return
        for check in (lights, skies, motion):
            check(OPENGL)
        os.chdir("/")


main()
