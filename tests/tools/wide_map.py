#!/usr/bin/env python3
"""A map of 40,000 by 20,000 pixels is read by rows: reduced, said, in bounded memory, and seen as the
same map of 4,000 by 2,000 pixels is.

wide_map.py PANWRIGHT
"""

import array
import json
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile
import zlib

PROGRAM = sys.argv[1]
BLOCK = 10  # pixels a side that have one code
WIDTH, HEIGHT = 4000, 2000  # blocks
MOST_KIB = 400 * 1024  # 237 MiB measured; all pixels as bytes would take 3.2 GB


def code(column, row):
    return 20 + (column // 50 * 7 + row // 40 * 13) % 230


def write_map(path, block):
    """A grey PNG, row after row."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    packer = zlib.compressobj(1)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH * block, HEIGHT * block, 8, 0, 0, 0, 0)))
        for row in range(HEIGHT):
            if row % 40 == 0:
                line = b"\0" + b"".join(bytes([code(column, row)]) * block for column in range(WIDTH))
            for _ in range(block):
                if packed := packer.compress(line):
                    file.write(chunk(b"IDAT", packed))
        file.write(chunk(b"IDAT", packer.flush()))
        file.write(chunk(b"IEND", b""))


def image_of(folder, path):
    """Radiance of the planet that fills the image, and what was said."""
    out = folder / "out.npy"
    done = subprocess.run(
        [PROGRAM, "render", "-o", str(out), "--engine", "reference", "--samples", "4", "--size", "24x24", "--fov", "30",
         "--look-at", "1 0 0", "--sun", "-1 0.2 0.3", "--json",
         "--planet", f"rock=9000km 0 0 radius=6000km albedo=0.3 map={path}"],
        capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    data = out.read_bytes()
    begin = 10 + struct.unpack("<H", data[8:10])[0]
    return array.array("f", data[begin:]), json.loads(done.stdout)["diagnostics"]


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    small, wide = folder / "small.png", folder / "wide.png"
    write_map(small, 1)
    write_map(wide, BLOCK)
    want, said = image_of(folder, small)
    assert not [one for one in said if one["code"] == "N5042"], said
    got, said = image_of(folder, wide)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    told = [one["message"] for one in said if one["code"] == "N5042"]
    assert told == ["a map of 40000 by 20000 pixels: means of 10 by 10 are used"], said
    worst = max(abs(a - b) for a, b in zip(got, want))
    print(f"peak {peak / 1024:.0f} MiB, images {worst:.1e} apart, brightest {max(want):.3g}")
    assert max(want) > 2 * min(want) > 0, "the map is not seen"
    assert worst <= 1e-6, worst
    assert peak < MOST_KIB, peak
