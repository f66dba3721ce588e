#!/usr/bin/env python3
"""Steers a camera to a docking ring by what a server measures: `panwright serve client.pxn`, then docking.py [PORT].

The camera looks along -z, at first 14 m above the client and 2 m beside its axis. Each step takes an image, finds the
centre of brightness, asks for the surface point under it, and moves: half of the way sideways, a third of the way down.
It ends 3 m above the surface, centred to 2 cm. docking.c and docking.m do the same.
"""

import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "server" / "clients"))
import panwright_client

FOV = math.radians(40)
END = 3.0  # metres above the surface
DOWN = (0, 1, 0, 0)  # right is +x, up in the image is +y


def centre(image):
    """Centre of brightness of a PPM: x and y from (0, 0) lower left to (1, 1) upper right."""
    width, height, pixels = panwright_client.read_ppm(image)
    grey = pixels[1::3]
    rows = [sum(grey[y * width:(y + 1) * width]) for y in range(height)]
    columns = [sum(grey[x::width]) for x in range(width)]
    total = max(sum(rows), 1)
    x = sum((i + 0.5) * value for i, value in enumerate(columns)) / total
    y = sum((i + 0.5) * value for i, value in enumerate(rows)) / total
    return x / width, 1 - y / height


def main():
    port = int(sys.argv[1]) if len(sys.argv) > 1 else panwright_client.PORT
    position = [2.0, -1.5, 14.0]
    with panwright_client.Client(port=port) as server:
        server.set_field_of_view(FOV)
        server.set_sun(0, math.radians(90))
        for step in range(40):
            server.set_viewpoint(position, DOWN)
            place = centre(server.image())
            point, = server.points([place])
            if point is None:
                sys.exit("the client is out of sight")
            distance = position[2] - point[2]
            aside = [(number - 0.5) * 2 * math.tan(FOV / 2) * distance for number in place]
            print(f"step {step}: {distance:.3f} m above the surface, {math.hypot(*aside):.3f} m off its middle")
            if abs(distance - END) < 0.05 and math.hypot(*aside) < 0.02:
                print(f"docked at {position[0]:.2f} {position[1]:.2f} {position[2]:.2f}")
                return
            position = [position[0] + aside[0] / 2, position[1] + aside[1] / 2, position[2] - (distance - END) / 3]
    sys.exit("the camera did not reach the ring")


if __name__ == "__main__":
    main()
