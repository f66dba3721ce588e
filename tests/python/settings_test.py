"""Every setting of schemas/views.toml from Python and from the program: the same numbers.

    settings_test.py PANWRIGHT SCHEMA        PYTHONPATH names the module's folder
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import typing
import unittest
import warnings

import numpy as np

import panwright as pw
from panwright import _views

PROGRAM, SCHEMA = sys.argv[1], pathlib.Path(sys.argv[2])
OPTIONS = [option for group in tomllib.loads(SCHEMA.read_text())["group"] for option in group["option"]]

# Files of an image, and what is opened, are arguments of Python's own.
NOT_OF_IMAGES = {"output", "outputs", "targets"}
OF_SCENARIOS = {"line-time", "tdi"}
# A shiny body with a mirror, a dish, a wing that turns and a camera: small, as each setting draws it twice.
CRAFT = """<pangu_model ver="1">
  <material name="gold"><ggx> 0.1 </ggx><conductor metal="Au"/></material>
  <material name="white"><lambert/><diffuse> 0.8 0.8 0.7 </diffuse></material>
  <material name="mirror" preset="osr_silica"/>
  <box size="2 2 3" bevel="0.1" material="gold"/>
  <box size="1.2 0.02 1.2" translate="0 -1.02 0" material="mirror"/>
  <sphere radius="0.6" translate="0.4 -0.6 1.8" material="white"/>
  <joint name="drive" type="continuous" axis="1 0 0">
    <box size="4 2 0.05" translate="3.2 0 0" material="white"/>
  </joint>
  <frame name="camera" translate="-1 -6 1" forward="0.2 1 -0.1" up="0 0 1"/>
</pangu_model>
"""
PLAIN = {"size": [24, 16], "samples": 1, "shadows": "hard", "camera": [0, -12, 2], "sun": [1, -1, 0.5]}
CAMERA = 'size = [24, 16]\nfocal_length_mm = 0.3\npixel_um = 10\n[optics]\nf_number = 5\n[detector]\nexposure_s = 1e-4\n'
LENS = {"intrinsics": [30, 30, 12, 8]}
DETECTOR = {"detector": "[optics]\naperture_mm = 1\n[detector]\npixel_um = 10\nexposure_s = 1e-4\n", **LENS}
TRACED = {"engine": "reference", "shadows": None}
# Values in place of the schema's examples, and what a setting needs beside it; None: left out.
BESIDE = {
    "camera-frame": {"camera_frame": "camera", "camera": None},
    "distortion": LENS, "detector": DETECTOR, "exposure": {**DETECTOR, "exposure": 1e-3},
    "gain": DETECTOR, "temperature": DETECTOR, "noise-seed": DETECTOR, "frame-number": DETECTOR,
    "camera-file": {"camera_file": "camera.toml", "size": None},
    "mount": {"mount": [0.8, 0.0, 0.0, 0.6]},
    "pose": {"pose": [0, 1, 0, 1, 0, 0, 0]}, "joint": {"joint": {"drive": "30deg"}},
    "define": {"define": {}},
    "star-catalogue": {"star_catalogue": "stars.csv", "stars": 6, "fov": 60},
    "stars": {"fov": 60}, "sky": {"date": "2026-01-01T12:00:00", "orbit": "a=6778km e=0 i=51.6 raan=30 aop=0 nu=90"},
    "date": {"stars": 4, "fov": 60}, "orbit": {"sky": "earth", "date": "2026-01-01T12:00:00"},
    "quality": {"samples": None, "shadows": None}, "pixel-error": {"samples": None}, "indirect": {"shadows": None},
    "shadows": {"sun_points": 4}, "sun-points": {"sun_points": 4, "shadows": "soft"},
    "engine": TRACED, "until-error": {**TRACED, "until_error": "20%"}, "max-samples": {**TRACED, "until_error": "20%", "max_samples": 64},
    "bounces": TRACED, "seed": TRACED, "no-sun-disc": TRACED, "limb-darkening": TRACED,
}


def view_of(option):
    name = option["name"].replace("-", "_")
    view = {**PLAIN, **({name: json.loads(option["example"])} if "example" in option else {}), **BESIDE.get(option["name"], {})}
    assert name in view, f"{name}: neither an example nor a value of this test"
    return {key: value for key, value in view.items() if value is not None}


class Settings(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        (self.path / "camera.toml").write_text(CAMERA)
        self.craft = self.path / "craft.pxn"
        self.craft.write_text(CRAFT)
        (self.path / "stars.csv").write_text("ra[deg],dec[deg],v[mag]\n90,0,1\n91,1,2\n")

    def run_program(self, *words):
        subprocess.run([PROGRAM, *map(str, words)], check=True, capture_output=True, text=True, cwd=self.path)

    def test_all_are_members_of_views(self):
        members = set(typing.get_type_hints(_views.View))
        for option in OPTIONS:
            if option["name"] not in NOT_OF_IMAGES:
                self.assertIn(option["name"].replace("-", "_"), members)

    def test_images_are_the_program_s(self):
        options = [option for option in OPTIONS if option["name"] not in NOT_OF_IMAGES | OF_SCENARIOS]
        self.assertGreater(len(options), 50)
        views = [view_of(option) for option in options]
        for view in views:
            for file in ("camera_file", "star_catalogue"):
                if file in view:
                    view[file] = str(self.path / view[file])
        files = [{**view, "output": str(self.path / f"{k}.npz")} for k, view in enumerate(views)]
        (self.path / "views.json").write_text(json.dumps(files))
        self.run_program("render", self.craft, "--views", "views.json", "--gl", "osmesa")
        plain = None
        changed = 0
        with warnings.catch_warnings(), pw.Renderer(self.craft, gl="osmesa") as renderer:
            warnings.simplefilter("ignore", pw.PanwrightWarning)
            for option, image, view in zip(options, renderer.frames(views), files, strict=True):
                with self.subTest(option["name"]), np.load(view["output"]) as arrays:
                    names = sorted(name for name in arrays.files if name != "meta.json")
                    if option["name"] == "layers":  # those of files: images in memory have all
                        self.assertLess(set(names), set(image.keys()))
                    else:
                        self.assertEqual(names, sorted(image.keys()))
                    for name in names:
                        np.testing.assert_array_equal(arrays[name], image[name], name)
                    if option["name"] == "name":
                        plain = image["radiance"]
                    elif "radiance" in names:
                        changed += plain is not None and not np.array_equal(plain, image["radiance"])
        self.assertGreater(changed, 30, "settings have no effect")

    def test_those_of_scenarios_are_the_program_s(self):
        (self.path / "way.csv").write_text("time[s],camera.x[m],camera.y[m],camera.z[m]\n-5,-2,-12,0\n5,2,-12,0\n")
        (self.path / "run.toml").write_text(
            f'[targets]\ncraft = "{self.craft}"\n[[source]]\nfile = "way.csv"\n[view]\nsize = [24, 16]\nfov = 40\n'
            'quat = [0.70710678, -0.70710678, 0, 0]\nsamples = 1\nsun = [1, -1, 0.5]\n')
        for number, settings in enumerate(({"line_time": 0.02}, {"line_time": 0.02, "tdi": 2}, {"line_time": -0.02, "exposure": 0.3})):
            words = [word for name, value in settings.items() for word in ("--" + name.replace("_", "-"), value)]
            self.run_program("run", "run.toml", "-o", f"{number}", "--at", 0, "--gl", "osmesa", "--type", "npz", "--labels", *words)
            scenario = pw.Scenario(self.path / "run.toml", **settings)
            scenario.times = [0.0]
            image, = pw.frames(scenario, gl="osmesa", labels=True)
            with np.load(self.path / f"{number}/000000.npz") as arrays:
                np.testing.assert_array_equal(arrays["radiance"], image["radiance"])
            told = json.loads((self.path / f"{number}/000000.labels.json").read_text())["things"][0]
            self.assertEqual(image.things[0].visible_box, tuple(told["visible_box"]))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
