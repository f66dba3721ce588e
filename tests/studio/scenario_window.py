#!/usr/bin/env python3
"""Plays scenarios in the window by scripts under Xvfb. The image of the scenario's camera is that of `panwright run`.

    scenario_window.py PANWRIGHT FOLDER

Exit code 77: Xvfb is not installed (scripts/setup installs it).
"""
import os
import shutil
import struct
import subprocess
import sys

from window import MODEL, expect, failures, view

SCENARIO = """step = 10
look_at = "door"

[targets]
door = "door.pxn"

[[source]]
file = "way.csv"

[[source]]
formula = "fixed"
sun = [1, -1, 0.5]

[view]
camera_file = "wide.toml"
samples = 2
tone = "photo"
sun_irradiance = [180, 190, 170]
"""
WAY = """time[s],camera.x[m],camera.y[m],camera.z[m],door.joint.hinge[deg]
0,0,-9,1,0
20,3,-6,1,60
40,4,-3,1,90
"""
LENS = """size = [160, 120]
focal = 110
distortion = "brown"
coefficients = [-0.24, 0.05, 1e-3, -5e-4]
"""


def pixels(path):
    """The size and the compressed rows of a PNG: equal for equal images."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed, header = 8, b"", b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        content = data[at + 8:at + 8 + length]
        header = content if kind == b"IHDR" else header
        packed += content if kind == b"IDAT" else b""
        at += 12 + length
    return header, packed


def main():
    program, folder = sys.argv[1:3]
    if not shutil.which("xvfb-run"):
        print("xvfb-run is not installed: no window was opened")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    for name, text in (("door.pxn", MODEL), ("pass.toml", SCENARIO), ("way.csv", WAY), ("wide.toml", LENS)):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    # the camera's own image, with its lens: as `run` draws it
    subprocess.run([program, "run", "pass.toml", "-o", "frames", "--gl", "osmesa", "--quiet"], cwd=folder, check=True)
    report = view(program, folder, [
        {"wait": "exact"}, {"expect": ["frame", "0"]}, {"expect": ["pixels", "160x120"]},
        {"type": ["scenario/frame", "2"]}, {"wait": "exact"}, {"expect": ["time", "20"]}, {"screenshot": "own.png"},
        {"click": "tab/Save"}, {"click": "save/save"}, {"wait": 20}, {"wait": "saved"}], "pass.toml")
    expect("the image is that of run", pixels(f"{folder}/image.png") == pixels(f"{folder}/frames/000002.png"))
    command = report["render"].replace("panwright", program, 1).replace("-o image.png", "-o same.png")
    subprocess.run(["sh", "-c", command + " --quiet"], cwd=folder, check=True)
    expect("and that of the command", pixels(f"{folder}/image.png") == pixels(f"{folder}/same.png"))

    # playing, keys, the view from outside, which has poses and the Sun of the frame
    report = view(program, folder, [
        {"wait": "exact"}, {"type": ["scenario/frames a second", "40"]}, {"click": "scenario/play"}, {"wait": "played"},
        {"expect": ["frame", "4"]}, {"expect": ["playing", "false"]}, {"key": "left"}, {"expect": ["frame", "3"]},
        {"click": "scenario/next"}, {"click": "scenario/previous"}, {"expect": ["frame", "3"]},
        {"type": ["scenario/frame", "70"]}, {"expect": ["frame", "4"]},
        {"expect": ["limited", "frame takes 0 to 4: 70 was brought to 4"]},
        {"key": "C"}, {"expect": ["outside", "true"]}, {"wait": "exact"}, {"screenshot": "outside.png"},
        {"click": "camera/targets"}, {"wait": "exact"}, {"screenshot": "targets.png"},
        {"drag": {"from": [0.4, 0.5], "to": [0.6, 0.5]}}, {"click": "tab/Joints"}, {"wait": "exact"},
        {"screenshot": "joints.png"}], "pass.toml")
    expect(report["render"], "--joint door/hinge=1.5707963267948966rad" in report["render"]
           and "--sun '1 -1 0.5'" in report["render"] and "--camera-file" not in report["render"])

    # mistakes: in the scenario, in the trajectory, and a model that changes; each has its place
    view(program, folder, [
        {"wait": "exact"}, {"type": ["scenario/frame", "1"]},
        {"replace": {"file": "pass.toml", "text": "look_at", "with": "lok_at"}}, {"wait": "read"},
        {"expect": ["failed", "true"]}, {"expect": ["errors", "1"]}, {"screenshot": "wrong.png"}, {"expect": ["frame", "1"]},
        {"replace": {"file": "pass.toml", "text": "lok_at", "with": "look_at"}}, {"wait": "exact"}, {"expect": ["failed", "false"]},
        {"replace": {"file": "way.csv", "text": "hinge", "with": "hing"}}, {"wait": "read"}, {"expect": ["failed", "true"]},
        {"replace": {"file": "way.csv", "text": "hing[", "with": "hinge["}}, {"wait": "exact"}, {"expect": ["failed", "false"]},
        {"replace": {"file": "way.csv", "text": "40,4", "with": "60,4"}}, {"wait": "exact"},
        {"type": ["scenario/frame", "99"]}, {"expect": ["frame", "6"]},
        {"replace": {"file": "door.pxn", "text": "0.5 0.5 0.5", "with": "0.5 0.1 0.1"}}, {"wait": "exact"},
        {"expect": ["frame", "6"]}, {"replace": {"file": "wide.toml", "text": "160, 120", "with": "80, 60"}}, {"wait": "exact"},
        {"expect": ["pixels", "80x60"]}], "pass.toml")

    # a trajectory alone, with the model beside it; and what has no model
    view(program, folder, [{"wait": "exact"}, {"expect": ["targets", "1"]}, {"type": ["scenario/frame", "2"]}, {"expect": ["time", "60"]}],
         "way.csv", "door.pxn")
    view(program, folder, [{"wait": "read"}, {"expect": ["failed", "true"]}, {"expect": ["errors", "1"]}], "way.csv")
    view(program, folder, [{"wait": "read"}, {"expect": ["errors", "1"]}], "way.csv", "pass.toml")
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
