#!/usr/bin/env python3
"""Writes crater.img: 192 x 192 heights of a made crater field near the lunar south pole, 5 m a post, and a filled void.

Craters are bowls with rims that fall off by their third power; the ground is a sum of waves. Numbers are half metres over
the sphere, 16 bits, the low byte first. crater.lbl describes them. Also albedo.img, bright rays of two young craters and dark
ground in the west, in percent of reflectance, of albedo.lbl; and body.tab: plates of an ellipsoid with a dent.
"""
import math
import pathlib
import struct

HERE = pathlib.Path(__file__).resolve().parent
SIDE, POST, VOID = 192, 5.0, -32768
# column, row, radius (metres), depth (metres)
CRATERS = [(70, 78, 210, 62), (138, 128, 120, 38), (150, 44, 75, 20), (36, 150, 95, 21), (104, 160, 45, 12), (22, 40, 50, 10),
           (112, 92, 32, 8), (172, 92, 38, 9), (88, 26, 28, 6), (60, 120, 22, 5), (170, 170, 60, 13), (128, 18, 20, 4)]


def height(x, y):
    out = 420 + 0.09 * POST * (x - y / 2)
    for k in range(1, 9):
        turn, length = 2.4 * k * k, 640 / 1.55**k
        phase = 2 * math.pi * (math.cos(turn) * x + math.sin(turn) * y) * POST / length
        out += 0.012 * length * math.sin(phase + 1.7 * k)
    for column, row, radius, depth in CRATERS:
        r = math.hypot(x - column, y - row) * POST / radius
        rim = 0.2 * depth
        out += (rim + depth) * r * r - depth if r < 1 else rim * max(0.0, r**-3 - 0.01)
    return out


def albedo(x, y):
    mare = 1 / (1 + math.exp((x - 70 + 12 * math.sin(0.06 * y) + 6 * math.sin(0.17 * y + 1)) / 7))
    out = 12 - 5 * mare
    for column, row, radius, rays in ((112, 92, 32, 9), (36, 150, 95, 7)):
        r = math.hypot(x - column, y - row) * POST / radius
        turn = math.atan2(y - row, x - column)
        ray = max(0, math.cos(rays * turn + 2 * math.sin(3 * turn)))**4
        out += 14 * math.exp(-r * r) + 9 * math.exp(-0.45 * r) * (0.25 + 0.75 * ray)
    return round(min(out, 40) * 5)


def body():
    lines, plates, around, rings = [], [], 36, 17
    points = [(0, 0, 1)]
    for i in range(1, rings + 1):
        a = math.pi * i / (rings + 1)
        points += [(math.sin(a) * math.cos(2 * math.pi * j / around), math.sin(a) * math.sin(2 * math.pi * j / around), math.cos(a))
                   for j in range(around)]
    points.append((0, 0, -1))
    for x, y, z in points:
        dent = 1 - 0.22 * math.exp(-((x - 0.5)**2 + (y + 0.75)**2 + (z - 0.43)**2) / 0.16)
        dent *= 1 + 0.05 * math.sin(5 * x + 1) * math.sin(6 * y) + 0.03 * math.sin(11 * z + 4 * x)
        lines.append(f"v {0.9 * x * dent:12.6f} {0.62 * y * dent:12.6f} {0.5 * z * dent:12.6f}")
    at = lambda i, j: 2 + (i - 1) * around + j % around
    last = len(points)
    for j in range(around):
        plates.append((1, at(1, j), at(1, j + 1)))
        for i in range(1, rings):
            plates.append((at(i, j), at(i + 1, j), at(i + 1, j + 1)))
            plates.append((at(i, j), at(i + 1, j + 1), at(i, j + 1)))
        plates.append((at(rings, j), last, at(rings, j + 1)))
    lines += [f"f {a:6d} {b:6d} {c:6d}" for a, b, c in plates]
    return "\n".join(lines) + "\n"


def main():
    posts = [round(2 * height(x, y)) for y in range(SIDE) for x in range(SIDE)]
    for y in range(176, 186):
        for x in range(8, 8 + 3 * (y - 175)):
            posts[y * SIDE + x] = VOID
    (HERE / "crater.img").write_bytes(struct.pack(f"<{len(posts)}h", *posts))
    (HERE / "albedo.img").write_bytes(bytes(albedo(x, y) for y in range(SIDE) for x in range(SIDE)))
    (HERE / "body.tab").write_text(body())


if __name__ == "__main__":
    main()
