#!/usr/bin/env python3
"""Images for clients of CORTO's closed loop: poses by UDP, PNG by TCP. Standard library alone.

    python3 panwright_corto.py [--address 127.0.0.1] [--pose-port 51001] [--image-port 30001] [--scale 1] MODEL… [options of panwright serve]

A pose is 17 big-endian doubles: the Sun's position, then position and quaternion w x y z of the camera and of the body; 7 more for each further
body. With 21 (and 7 more for each), the Sun has a quaternion too. The camera looks along -z, with y up, as Blender's. Positions are in units of
--scale metres. An image is its length, a little-endian u64, and a PNG. The direction to the Sun is that from the first body. Bodies are the models, in order.

One client at a time is connected, as there. A packet that is no pose, or whose image fails, is answered with a length of 0.
"""

import argparse
import select
import socket
import struct
import sys

from panwright_adapter import Renderer, finite, product, unit
from panwright_lines import ServerError

VIEW_FROM_BLENDER = [0, 1, 0, 0]  # half a turn about x: y down, z forward
SLOWEST = 30  # seconds, for a client to take an image


def view_of(packet, bodies, scale):
    """The view of a packet, for the models of these names."""
    if len(packet) % 8:
        raise ValueError(f"{len(packet)} bytes are no doubles")
    values = finite(struct.unpack(f">{len(packet) // 8}d", packet))
    plain = 3 + 7 * (1 + len(bodies))
    if len(values) not in (plain, plain + 4):
        raise ValueError(f"{len(values)} numbers, expected {plain} or {plain + 4} for {len(bodies)} bodies")
    sun = values[:3]
    rest = values[3 if len(values) == plain else 7:]
    camera, *others = (rest[k:k + 7] for k in range(0, len(rest), 7))
    to_sun = [a - b for a, b in zip(sun, others[0])]
    return {"camera": [scale * x for x in camera[:3]], "quat": product(unit(camera[3:]), VIEW_FROM_BLENDER), "sun": to_sun,
            "pose": {name: [*(scale * x for x in body[:3]), *unit(body[3:])] for name, body in zip(bodies, others)}}


def serve(renderer, bodies, poses, images, scale):
    connection, number = None, 0
    while True:
        ready, _, _ = select.select([poses, images] + ([connection] if connection else []), [], [], 1)  # not for ever: a signal just before it does not wake it
        if connection in ready and not connection.recv(4096):
            connection.close()
            connection = None
            continue
        if images in ready:
            newer, _ = images.accept()
            if connection:
                newer.close()  # one is being served
            else:
                connection = newer
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                connection.settimeout(SLOWEST)
        if poses not in ready:
            continue
        packet, _ = poses.recvfrom(65536)
        number += 1
        try:
            png = renderer.png(view_of(packet, bodies, scale))
        except (ValueError, ServerError) as error:
            print(f"pose {number}: {error}", file=sys.stderr, flush=True)
            png = b""
        if not connection:  # a client sends poses once it is connected; its connection may wait beside
            if not select.select([images], [], [], 1)[0]:
                continue
            connection, _ = images.accept()
            connection.settimeout(SLOWEST)
        try:
            connection.sendall(struct.pack("<Q", len(png)) + png)
        except OSError:
            connection.close()
            connection = None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog="Other words are those of `panwright serve`.")
    parser.add_argument("--address", default="127.0.0.1", help="to listen on (default 127.0.0.1: this machine alone); there is no password")
    parser.add_argument("--pose-port", type=int, default=51001)
    parser.add_argument("--image-port", type=int, default=30001)
    parser.add_argument("--scale", type=float, default=1, help="metres of a unit (default 1)")
    options, words = parser.parse_known_args()
    with Renderer(words) as renderer:
        answer = renderer.lines.ask({"image": "inline", "size": [8, 8], "samples": 1})
        if not answer["ok"]:
            raise ServerError(answer)
        bodies = list(answer["settings"].get("pose", {}))
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as poses, socket.create_server((options.address, options.image_port)) as images:
            poses.bind((options.address, options.pose_port))
            print(f"poses on UDP {options.address}:{poses.getsockname()[1]}, images on TCP {images.getsockname()[1]}, bodies: {', '.join(bodies)}",
                  flush=True)
            try:
                serve(renderer, bodies, poses, images, options.scale)
            except KeyboardInterrupt:
                pass


if __name__ == "__main__":
    main()
