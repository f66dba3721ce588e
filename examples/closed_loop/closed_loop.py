#!/usr/bin/env python3
"""Steers a camera with the images that it takes: one panwright process renders, this program decides.

closed_loop.py PANWRIGHT MODEL

The target is off the boresight at first. Each step renders one view, finds the centre of brightness of the image, and
turns the boresight towards it, until that is within a pixel of the image's middle. Without libraries: images are .npy.
"""

import array
import json
import math
import os
import struct
import subprocess
import sys
import tempfile

SIZE = 128  # pixels
FOV = 40  # degrees
FOCAL = SIZE / 2 / math.tan(math.radians(FOV / 2))  # pixels
CAMERA = (0, -25, 3)  # metres


class Renderer:
    """A panwright process: one view in, one answer out."""

    def __init__(self, program, model):
        self.process = subprocess.Popen([program, "render", model, "--views", "-"], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True, bufsize=1)

    def render(self, **view):
        self.process.stdin.write(json.dumps(view) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line:
            raise RuntimeError("panwright ended")
        return json.loads(line)

    def close(self):
        self.process.stdin.close()
        return self.process.wait()


def brightness(path):
    """The sum over bands, row by row, of a .npy of (H, W, 3) float32."""
    with open(path, "rb") as file:
        header, = struct.unpack("<8xH", file.read(10))
        file.seek(10 + header)
        values = array.array("f", file.read())
    return [sum(values[i:i + 3]) for i in range(0, len(values), 3)]


def centre(image):
    total = sum(image)
    column = sum((i % SIZE + 0.5) * value for i, value in enumerate(image)) / total
    row = sum((i // SIZE + 0.5) * value for i, value in enumerate(image)) / total
    return column, row


def main():
    renderer = Renderer(sys.argv[1], sys.argv[2])
    look_at = [4.0, 0.0, -2.0]  # wrong on purpose
    with tempfile.TemporaryDirectory() as folder:
        frame = os.path.join(folder, "frame.npy")
        for step in range(10):
            answer = renderer.render(name=f"step {step}", output=frame, size=SIZE, fov=FOV, camera=CAMERA,
                                     look_at=look_at, sun=[0.4, -1, 0.5], samples=2)
            if not answer["ok"]:
                sys.exit(answer["diagnostics"][0]["message"])
            column, row = centre(brightness(frame))
            off = column - SIZE / 2, row - SIZE / 2
            print(f"{answer['name']}: {math.hypot(*off):.1f} pixels off, {answer['ms']:.0f} ms")
            if math.hypot(*off) < 1:
                break
            # the camera looks along +y with z up, nearly: columns are x, rows are -z
            distance = -CAMERA[1]
            look_at[0] += off[0] / FOCAL * distance
            look_at[2] -= off[1] / FOCAL * distance
        else:
            sys.exit("the target was not centred")
    sys.exit(renderer.close())


if __name__ == "__main__":
    main()
