#!/usr/bin/env python3
"""Views of the servicer from 100 km to 5 m, or as it drifts by at a few pixels: a views file for `panwright render --views`.

    approach.py [--frames N] [--out FOLDER] > views.json
    approach.py --drift [--frames N] [--out FOLDER] > views.json

The approach has one camera, and ranges that fall by the same factor from frame to frame; where the target is below a
pixel the exposure makes up for it.
The drift shows each place twice: with one sample a pixel, where small parts come and go, and as an imposter.
"""
import argparse
import json
import math

IFOV = 0.012  # radians
SIZE = 1.5  # metres: of a square that is as bright, about
SIDE = (1.0, -1.1, 0.7)  # where the camera stands, from the servicer


def place(distance, right=0.0):
    """A camera so far away, so many metres to the right of looking at the servicer."""
    length = math.hypot(*SIDE)
    across = math.hypot(SIDE[0], SIDE[1])
    x, y, z = (distance * value / length for value in SIDE)
    dx, dy = -SIDE[1] / across * right, SIDE[0] / across * right
    return {"camera": [x + dx, y + dy, z], "look-at": [dx, dy, 0.2]}


def approach(frames, out):
    views = []
    for i in range(frames):
        distance = 1e5 * (5 / 1e5) ** (i / max(frames - 1, 1))
        # below a pixel its light falls as the square of the range
        stops = 0.3 + 2 * max(math.log2(distance * IFOV / SIZE), 0)
        views.append({"output": f"{out}/approach_{i:03d}.png", **place(distance), "ifov": f"{IFOV}rad", "ev": stops})
    return views


def drift(frames, out):
    distance, ifov = 500.0, 2e-3  # some ten pixels
    ways = {"aliased": {"samples": 1, "imposters": "off", "specular-filter": "off"}, "imposter": {"samples": "auto", "imposters": "auto"}}
    views = []
    for name, way in ways.items():
        for i in range(frames):
            # a third of a pixel a frame
            views.append({"output": f"{out}/drift_{name}_{i:03d}.png", **place(distance, 0.37 * i * ifov * distance),
                          "ifov": f"{ifov}rad", "ev": 0.5, **way})
    return views


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=12)
    parser.add_argument("--out", default=".")
    parser.add_argument("--drift", action="store_true")
    given = parser.parse_args()
    print(json.dumps((drift if given.drift else approach)(given.frames, given.out), indent=1))


if __name__ == "__main__":
    main()
