#!/usr/bin/env python3
"""Cameras with a detector in the window, by scripts under Xvfb: the numbers on the screen are those of `panwright render` and `run`.

    detector_window.py PANWRIGHT FOLDER

Exit code 77: Xvfb is not installed (scripts/setup installs it).
"""
import os
import shutil
import struct
import subprocess
import sys
import zlib

from scenario_window import pixels
from window import MODEL, expect, failures, view

CAMERA = """size = [96, 72]
focal_length_mm = 12
pixel_um = 60
[optics]
aperture_mm = 2
psf_px = 0.5
[detector]
exposure_s = 4e-5
full_well_e = 20000
bits = 8
read_noise_e = 120
bias_dn = 4
dark_e_per_s = 2e6
dsnu = 0.2
prnu = 0.02
"""
SCENARIO = """begin = 0
end = 1
step = 1
look_at = "door"
[targets]
door = "door.pxn"
[[source]]
formula = "fixed"
position = [2, -9, 3]
sun = [1, -1, 0.5]
[view]
camera_file = "camera.toml"
"""


def rows(path):
    """Rows of a PNG of 8 bits, each of tuples of its channels."""
    with open(path, "rb") as file:
        data = file.read()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        content = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", content[:10])
        packed += content if kind == b"IDAT" else b""
        at += 12 + length
    assert bits == 8
    channels = {0: 1, 2: 3, 6: 4}[color]
    flat, stride = zlib.decompress(packed), width * channels
    out, before = [], bytearray(stride)
    for y in range(height):
        kind, line = flat[y * (stride + 1)], bytearray(flat[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = line[i - channels] if i >= channels else 0
            b, c = before[i], before[i - channels] if i >= channels else 0
            if kind == 4:
                p = a + b - c
                a = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, a)[kind]) & 255
        out.append([tuple(line[i:i + channels]) for i in range(0, stride, channels)])
        before = line
    return out


def shows(screenshot, image):
    """Every number of an image is on the screen as grey, 8 times larger: black is 0, white the largest of 8 bits."""
    screen, numbers = rows(screenshot), rows(image)
    left, top = 448, 37  # right of a panel of 384 pixels, below a bar of 34, above 104 of messages
    wrong = sum(screen[top + 8 * y + 4][left + 8 * x + 4][:3] != 3 * (numbers[y][x][0],)
                for y in range(len(numbers)) for x in range(len(numbers[0])))
    expect(f"{wrong} pixels of {screenshot} are not those of {image}", wrong == 0)
    expect("the image is not of one grey", len({each for row in numbers for each in row}) > 20)


def main():
    program, folder = sys.argv[1:3]
    if not shutil.which("xvfb-run"):
        print("xvfb-run is not installed: no window was opened")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    for name, text in (("door.pxn", MODEL), ("camera.toml", CAMERA), ("stay.toml", SCENARIO)):
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def drawn(command, output):
        words = command.replace("panwright", program, 1).replace("-o image.png", f"-o {output}")
        subprocess.run(["sh", "-c", words + " --quiet"], cwd=folder, check=True)

    # as the file has it; then with another exposure, gain and temperature; each is on the screen, saved, and that of the command
    camera = ("--camera-file", "camera.toml")
    save = [{"click": "tab/Save"}, {"click": "save/save"}, {"wait": 20}, {"wait": "saved"}]
    begin = [{"wait": "read"}, {"type": ["camera/range", "9"]}]
    still = [{"click": "tab/Image"}, {"wait": "exact"}, {"wait": 4}]
    report = view(program, folder, [
        *begin, {"wait": "exact"}, {"expect": ["pixels", "96x72"]}, {"expect": ["exposure", "4e-05"]},
        *still, {"screenshot": "own.png"}, *save], *camera, "door.pxn")
    expect(report["render"], "--camera-file camera.toml" in report["render"] and "--fov" not in report["render"])
    drawn(report["render"], "same.png")
    expect("the saved numbers are those of render", pixels(f"{folder}/image.png") == pixels(f"{folder}/same.png"))
    shows(f"{folder}/own.png", f"{folder}/same.png")
    report = view(program, folder, [
        *begin, {"click": "tab/Sun"}, {"wait": 3}, {"type": ["detector/exposure", "1e-4"]}, {"type": ["detector/gain", "0.02"]},
        {"type": ["detector/temperature", "310"]}, *still, {"expect": ["exposure", "0.0001"]}, {"screenshot": "changed.png"}, *save],
        *camera, "door.pxn")
    for each in ("--exposure 0.0001", "--gain 0.02", "--temperature 310"):
        expect(f"{each} in {report['render']}", each in report["render"])
    drawn(report["render"], "other.png")
    expect("changed numbers are those of render", pixels(f"{folder}/image.png") == pixels(f"{folder}/other.png"))
    expect("they have changed", pixels(f"{folder}/other.png") != pixels(f"{folder}/same.png"))
    shows(f"{folder}/changed.png", f"{folder}/other.png")

    # saturated pixels are counted, and marked; automatic exposure; the file followed, with a mistake
    report = view(program, folder, [
        *begin, {"click": "tab/Sun"}, {"wait": 3}, {"type": ["detector/exposure", "1e-9"]},
        {"expect": ["limited", "exposure takes 1e-06 to 1000: 1e-09 was brought to 1e-06"]},
        {"type": ["detector/exposure", "10"]}, {"wait": "exact"}, {"wait": 4}, {"expect": ["white", str(96 * 72)]},
        {"screenshot": "white.png"}, {"click": "detector/auto"}, {"wait": "exact"}, {"wait": 4}, {"expect": ["failed", "false"]},
        {"click": "detector/reset"}, {"wait": "exact"}, {"expect": ["exposure", "4e-05"]},
        {"replace": {"file": "camera.toml", "text": "bits = 8", "with": "bits = 1"}}, {"wait": "read"}, {"expect": ["failed", "true"]},
        {"expect": ["errors", "1"]}, {"expect": ["exposure", "4e-05"]},
        {"replace": {"file": "camera.toml", "text": "bits = 1", "with": "bits = 8"}}, {"wait": "exact"}, {"expect": ["failed", "false"]},
        {"replace": {"file": "camera.toml", "text": "96, 72", "with": "48, 36"}}, {"wait": "exact"}, {"expect": ["pixels", "48x36"]},
        {"replace": {"file": "camera.toml", "text": "48, 36", "with": "96, 72"}}, {"wait": "exact"}, {"expect": ["pixels", "96x72"]}],
        *camera, "door.pxn")

    # a scenario with such a camera: as `run` draws it, where nothing moves
    subprocess.run([program, "run", "stay.toml", "-o", "frames", "--gl", "osmesa", "--quiet"], cwd=folder, check=True)
    view(program, folder, [
        {"wait": "exact"}, {"type": ["scenario/frame", "1"]}, *still, {"screenshot": "frame.png"}, *save], "stay.toml")
    expect("the frame is that of run", pixels(f"{folder}/image.png") == pixels(f"{folder}/frames/000001.png"))
    expect("frames differ in noise", pixels(f"{folder}/frames/000000.png") != pixels(f"{folder}/frames/000001.png"))

    # no camera there
    view(program, folder, [{"wait": "read"}, {"expect": ["failed", "true"]}, {"expect": ["errors", "1"]}], "--camera-file", "none.toml",
         "door.pxn")
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
