#!/usr/bin/env python3
"""Reads what `panwright mli` writes of a sheet with numpy alone, and holds its statistics against it.

mli_heights.py PANWRIGHT PRESET
"""

import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import numpy as np

PROGRAM, PRESET = sys.argv[1:3]


def grey16(path):
    """The codes of a 16-bit grey PNG whose rows are all of one of the filters."""
    data, at, pixels, size, text = path.read_bytes(), 8, b"", None, ""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            size = struct.unpack(">IIBB", body[:10])
        if kind == b"IDAT":
            pixels += body
        if kind == b"tEXt":
            text = body.decode("ascii")
        at += 12 + length
    width, height, bits, color = size
    assert (bits, color) == (16, 0), size
    raw = np.frombuffer(zlib.decompress(pixels), dtype=np.uint8).reshape(height, 1 + 2 * width)
    rows = np.zeros((height, 2 * width), dtype=np.uint8)
    for y in range(height):
        kind, line = raw[y, 0], raw[y, 1:].astype(int)
        above = rows[y - 1].astype(int) if y else np.zeros(2 * width, dtype=int)
        out = rows[y]
        for x in range(2 * width):
            left = int(out[x - 2]) if x > 1 else 0
            corner = int(above[x - 2]) if x > 1 else 0
            up = int(above[x])
            p = left + up - corner
            paeth = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))[2]
            out[x] = (int(line[x]) + (0, left, up, (left + up) // 2, paeth)[kind]) & 255
    return rows.view(">u2").astype(int), text


def main():
    failures = []

    def near(name, found, expected, tolerance):
        if not np.all(np.abs(np.asarray(found) - np.asarray(expected)) <= tolerance):
            failures.append(f"{name}: {found}, expected {expected} within {tolerance}")

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        line = [PROGRAM, "mli", PRESET, "--cells", "150", "--sheet-height", "0.3", "--sheet-width", "0.5",
                "--seed", "7", "--json"]
        done = subprocess.run([*line, "--height", folder / "h.npy", "--histogram", folder / "h.svg"],
                              capture_output=True, text=True, check=True)
        sheet = json.loads(done.stdout)["sheets"][0]
        subprocess.run([*line, "--height", folder / "h.png"], capture_output=True, check=True)
        heights = np.load(folder / "h.npy")
        codes, text = grey16(folder / "h.png")
    columns, rows = sheet["cells"]
    if heights.dtype != np.float64 or heights.shape != (rows + 1, columns + 1) or (columns, rows) != (150, 90):
        failures.append(f"heights are {heights.dtype} {heights.shape}")
    dx = sheet["width"] / columns
    # the hash of mli/sheet.h, so that the file holds the sheet to the bit
    word = 14695981039346656037
    for bits in heights.ravel().view(np.uint64).tolist():
        word = (word ^ bits) * 1099511628211 % 2**64
        word ^= word >> 32
    if f"{word:016x}" != sheet["checksum"]:
        failures.append(f"checksum {word:016x}, expected {sheet['checksum']}")
    # other orders of the same sums
    near("lowest", heights.min(), sheet["heights"][0], 0)
    near("highest", heights.max(), sheet["heights"][1], 0)
    near("rms", heights.std(), sheet["height_rms"], 1e-12)
    sy, sx = np.gradient(heights, dx)
    near("slope rms", np.sqrt((sx**2 + sy**2).mean()), sheet["slope_rms"], 1e-12)
    near("along axes", [np.sqrt((sx**2).mean()), np.sqrt((sy**2).mean())], sheet["slope_rms_axes"], 1e-12)
    # facets: two of each cell, cut from (i, j) to (i + 1, j + 1)
    across, up = np.diff(heights, axis=1) / dx, np.diff(heights, axis=0) / dx
    facets = {"x": np.concatenate([across[:-1].ravel(), across[1:].ravel()]),
              "y": np.concatenate([up[:, 1:].ravel(), up[:, :-1].ravel()])}
    histogram = sheet["slope_histogram"]
    for axis, slopes in facets.items():
        counted = histogram[axis]
        total = sum(counted["counts"]) + counted["below"] + counted["above"]
        if not total == histogram["facets"] == 2 * rows * columns == len(slopes):
            failures.append(f"{total} facets along {axis} are counted")
        near("deviation " + axis, slopes.std(), counted["deviation"], 1e-12)
        edges = histogram["lowest"] + histogram["bin"] * np.arange(len(counted["counts"]) + 1)
        # a slope on an edge may fall to either side
        near("counts " + axis, np.histogram(slopes, edges)[0], counted["counts"], 2)
    if sum(sheet["tilt_histogram"]) != 2 * rows * columns:
        failures.append("tilts are not of all facets")
    # the image: upside down, half a code off at most
    low, high = sheet["heights"]
    near("codes", codes[::-1] / 65535 * (high - low) + low, heights, 0.5001 * (high - low) / 65535)
    if not text.startswith("Comment\0height: 0 is "):
        failures.append(f"the comment is {text!r}")
    for failure in failures:
        print(failure)
    return 1 if failures else 0


sys.exit(main())
