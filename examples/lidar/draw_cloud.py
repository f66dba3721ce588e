#!/usr/bin/env python3
"""Draws a point cloud of `panwright lidar` (.npz, in the instrument's axes): from the instrument, and from the side.

    draw_cloud.py CLOUD.npz OUT.png [--image IMAGE.npz]       --image: radiance beside it, as wide as the cloud's views
"""
import argparse
import struct
import zlib

import numpy as np

SIDE = 360  # pixels


def png(path, rgb):
    height, width, _ = rgb.shape
    rows = b"".join(b"\0" + row.tobytes() for row in rgb)
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b"")]
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for kind, data in chunks:
            file.write(struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)))


def colors(share):
    """From near (yellow) over green to far (violet)."""
    stops = np.array([[250, 230, 60], [90, 200, 100], [40, 130, 150], [70, 60, 140], [70, 20, 90]], float)
    at = np.clip(share, 0, 1) * (len(stops) - 1)
    low = np.minimum(at.astype(int), len(stops) - 2)
    return (stops[low] + (at - low)[:, None] * (stops[low + 1] - stops[low])).astype(np.uint8)


def view(points, rgb, reach, size=3):
    """Orthographic: x to the right, y down, nearer points over farther ones."""
    out = np.full((SIDE, SIDE, 3), 16, np.uint8)
    order = np.argsort(-points[:, 2])
    place = ((points[:, :2] / reach + 1) * 0.5 * SIDE).astype(int)[order]
    for dy in range(size):
        for dx in range(size):
            x, y = place[:, 0] + dx, place[:, 1] + dy
            inside = (x >= 0) & (y >= 0) & (x < SIDE) & (y < SIDE)
            out[y[inside], x[inside]] = rgb[order][inside]
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cloud")
    parser.add_argument("output")
    parser.add_argument("--image")
    options = parser.parse_args()
    cloud = np.load(options.cloud)
    points = cloud["position"]
    if not len(points):
        raise SystemExit(f"{options.cloud} has no points")
    low, high = np.percentile(points, 1, axis=0), np.percentile(points, 99, axis=0)
    points = points - (low + high) / 2
    reach = 0.56 * np.max((high - low)[:2])
    rgb = colors(points[:, 2] / max((high - low)[2], 1e-9) + 0.5)
    angle = np.radians(65)
    turn = np.array([[np.cos(angle), 0, -np.sin(angle)], [0, 1, 0], [np.sin(angle), 0, np.cos(angle)]])
    panels = [view(points, rgb, reach), view(points @ turn.T, rgb, reach)]
    if options.image:
        radiance = np.load(options.image)["radiance"]
        codes = np.clip(np.pi * radiance, 0, 1) ** (1 / 2.2) * 255
        rows, columns = ((np.arange(SIDE) + 0.5) * n / SIDE for n in codes.shape[:2])
        panels.insert(0, codes[rows.astype(int)][:, columns.astype(int)].astype(np.uint8))
    gap = np.full((SIDE, 6, 3), 255, np.uint8)
    png(options.output, np.hstack([part for panel in panels for part in (panel, gap)][:-1]))
    print(f"{options.output}: {len(points)} points")


if __name__ == "__main__":
    main()
