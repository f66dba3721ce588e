#!/usr/bin/env python3
"""Views of the servicer as it deploys: prints a views file for `panwright render --views`.

    deploy.py [--frames N] [--out FOLDER] > views.json

First the wings unfold and turn to the Sun, then the dish finds the ground station, then the arm reaches out. The camera
drifts around. Every frame is the model with other joint values; nothing is compiled anew.
"""
import argparse
import json
import math


def ease(t, begin, end):
    """0 before `begin`, 1 after `end`, and a smooth step between."""
    x = min(max((t - begin) / (end - begin), 0), 1)
    return x * x * (3 - 2 * x)


def joints(t):
    """Values at a time from 0 to 1: degrees, metres."""
    folded = 90 * (1 - ease(t, 0.02, 0.35))
    turned = ease(t, 0.35, 0.5)
    dish = ease(t, 0.4, 0.6)
    reach = ease(t, 0.58, 0.9)
    return {
        "wing_left/fold": folded,
        "wing_right/fold": folded,
        "wing_left/drive": 60 * turned,
        "wing_right/drive": -60 * turned,
        "high_gain/azimuth": 60 * dish,
        "high_gain/elevation": 25 + 30 * dish,
        "arm/shoulder_yaw": 180 - 150 * reach,
        "arm/shoulder_pitch": 88 - 62 * reach,
        "arm/elbow": -176 + 232 * reach,
        "arm/wrist_pitch": 35 * reach,
        "arm/wrist_roll": 90 * reach,
        "arm/gripper/finger": 0.02 + 0.025 * ease(t, 0.88, 0.98),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--out", default=".")
    given = parser.parse_args()
    views = []
    for i in range(given.frames):
        t = i / max(given.frames - 1, 1)
        around = math.radians(-52 + 16 * t)
        views.append({
            "output": f"{given.out}/deploy_{i:03d}.png",
            "camera": [13.5 * math.cos(around), 13.5 * math.sin(around), 5.5 - t],
            "joint": joints(t),
        })
    print(json.dumps(views, indent=1))


if __name__ == "__main__":
    main()
