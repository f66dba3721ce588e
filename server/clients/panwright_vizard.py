#!/usr/bin/env python3
"""Camera images for Basilisk's vizInterface, in place of Vizard without a display. Needs zmq (Debian: python3-zmq).

    python3 panwright_vizard.py [--address 127.0.0.1] [--port 5556] NAME=MODEL… [options of panwright serve]

In Basilisk: viz = vizSupport.enableUnityVisualization(…, noDisplay=True), or liveStream=True. NAME is that of the spacecraft there. It answers PING,
SIM_UPDATE, REQUEST_INPUT and REQUEST_IMAGE_n. Of a message it takes spacecraft (position, attitude), celestial bodies (the Sun's direction; others as
spheres of their radius, "earth" and "moon" with their light) and cameras (place, attitude, field of view, resolution, image or depth). Spacecraft
without a model are not shown. Axes are those of Basilisk's inertial frame, about the spacecraft that carries the camera.
"""

import argparse
import math
import struct
import sys
import zlib

from panwright_adapter import Renderer, conjugate, finite, of_matrix, of_mrp, product, rotated, unit
from panwright_lines import ServerError

# Vizard's camera, which looks along -x with z up, from ours: its MRP to the camera frame is (1, 1, -1) / 3
VIZARD_FROM_CAMERA = conjugate(of_mrp([1 / 3, 1 / 3, -1 / 3]))
MOST_BYTES = 16 << 20  # of a message
DEPTH_PLANES = (0.1, 100.0)  # metres, where none are given


# ---- messages of protocol buffers: tag, then a number, eight or four bytes, or bytes of a length

def varint(data, at):
    value, shift = 0, 0
    while True:
        if at >= len(data) or shift > 63:
            raise ValueError("a message is cut or damaged")
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return value, at


def fields(data):
    """Yields the number of each field and its value: an int or bytes."""
    at = 0
    while at < len(data):
        tag, at = varint(data, at)
        if tag & 7 == 0:
            value, at = varint(data, at)
        else:
            if tag & 7 == 2:
                size, at = varint(data, at)
            else:
                size = {1: 8, 5: 4}.get(tag & 7)
                if size is None:
                    raise ValueError("a message has a field of unknown type")
            if size > len(data) - at:
                raise ValueError("a message is cut or damaged")
            value, at = data[at:at + size], at + size
        yield tag >> 3, value


class Message:
    def __init__(self, data):
        self.fields = {}
        for number, value in fields(data):
            self.fields.setdefault(number, []).append(value)

    def bytes(self, number):
        return [value for value in self.fields.get(number, []) if isinstance(value, bytes)]

    def text(self, number):
        return (self.bytes(number) or [b""])[-1].decode("utf-8", "replace")

    def whole(self, number):
        found = [value for value in self.fields.get(number, []) if isinstance(value, int)]
        return found[-1] if found else 0

    def wholes(self, number):
        """A list of numbers, packed or not."""
        out = []
        for value in self.fields.get(number, []):
            at = 0
            while isinstance(value, bytes) and at < len(value):
                one, at = varint(value, at)
                out.append(one)
            if isinstance(value, int):
                out.append(value)
        return out

    def doubles(self, number):
        data = b"".join(self.bytes(number))
        return finite(struct.unpack(f"<{len(data) // 8}d", data[:len(data) // 8 * 8]))

    def vector(self, number, what):
        out = self.doubles(number)
        if len(out) < 3:
            raise ValueError(f"{what} has {len(out)} numbers, expected 3")
        return out[:3]


class Scene:
    """State of the last message, and the views of its cameras."""

    def __init__(self, names):
        self.names = names
        self.spacecraft, self.bodies, self.cameras = {}, {}, {}

    def update(self, data):
        message = Message(data)
        spacecraft = {}
        for one in map(Message, message.bytes(3)):
            name = one.text(1)
            spacecraft[name] = one.vector(2, f"the position of {name}"), of_mrp(one.vector(4, f"the attitude of {name}"))
        bodies = {}
        for one in map(Message, message.bytes(2)):
            name = one.text(1)
            rotation = one.doubles(4)
            radius = (one.doubles(6) or [0])[-1]
            bodies[name] = one.vector(2, f"the position of {name}"), rotation, 1e3 * radius or self.bodies.get(name, (0, 0, 0))[2]
        self.spacecraft, self.bodies = spacecraft, bodies
        for one in map(Message, message.bytes(4)):
            self.cameras[one.whole(1)] = one

    def view(self, number):
        """The view of a camera, and its Message."""
        if number not in self.cameras:
            raise ValueError(f"there is no camera {number}")
        camera = self.cameras[number]
        parent = camera.text(2)
        if parent not in self.spacecraft:
            raise ValueError(f"camera {number} is on '{parent}', which is no spacecraft")
        origin, attitude = self.spacecraft[parent]
        turned = product(attitude, product(of_mrp(camera.vector(8, "a camera's attitude")), VIZARD_FROM_CAMERA))
        width, height = (camera.wholes(4) + [512, 512])[:2]
        if not (1 <= width <= 16384 and 1 <= height <= 16384):
            raise ValueError(f"camera {number} has {width} x {height} pixels")
        along_y = (camera.doubles(3) or [0])[-1]
        if not 0 < along_y < 179:
            raise ValueError(f"camera {number} has a field of view of {along_y} degrees")
        across = math.degrees(2 * math.atan(width / height * math.tan(math.radians(along_y) / 2)))
        here = lambda position: [a - b for a, b in zip(position, origin)]  # noqa: E731
        view = {"camera": rotated(attitude, camera.vector(7, "a camera's position")), "quat": unit(turned), "size": [width, height], "fov": across,
                "pose": {}, "planet": {}}
        for name in self.names:
            if name in self.spacecraft:
                position, rotation = self.spacecraft[name]
                view["pose"][name] = [*here(position), *unit(rotation)]
            else:  # far behind all that is seen
                view["pose"][name] = [1e12, 1e12, 1e12, 1, 0, 0, 0]
        for name, (position, rotation, radius) in self.bodies.items():
            kind = name.lower().split("_")[0]
            if kind == "sun":
                view["sun"] = here(position)
                continue
            if kind not in ("earth", "moon") and not radius > 0:
                continue
            # the matrix turns from the inertial frame
            quaternion = conjugate(of_matrix(rotation[:9])) if len(rotation) >= 9 else [1, 0, 0, 0]
            text = " ".join(f"{x!r}" for x in [*here(position), *quaternion])
            view["planet"][kind] = text if kind in ("earth", "moon") else f"{text} radius={radius!r}"
        if not view["planet"]:
            del view["planet"]
        return view, camera


def grey_png(width, height, rows):
    """8 bits of grey, one bytes object a row."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 3)) + chunk(b"IEND", b""))


def depth_png(renderer, view, camera):
    """Depth between the clipping planes, white at the far one."""
    near, far = (camera.doubles(17) + list(DEPTH_PLANES))[:2] if len(camera.doubles(17)) >= 2 else DEPTH_PLANES
    if not far > near:
        raise ValueError("the clipping planes of the depth have no distance")
    width, height = view["size"]
    depths = renderer.depth(view)
    rows = [bytes(round(255 * min(max((depths[y, x] - near) / (far - near), 0), 1)) for x in range(width)) for y in range(height)]
    return grey_png(width, height, rows)


class Answers:
    def __init__(self, renderer, names):
        self.renderer, self.scene = renderer, Scene(names)

    def reply(self, parts):
        """Frames of the reply to the frames of a request."""
        head = parts[0]
        try:
            if head == b"PING":
                return [b"PONG"]
            if head == b"SIM_UPDATE":
                self.scene.update(parts[-1] if len(parts) > 1 else b"")
                return [b"OK"]
            if head == b"REQUEST_INPUT":
                return [b"VIZARD_INPUT", b""]
            if head.startswith(b"REQUEST_IMAGE_") and head[14:].isdigit():
                view, camera = self.scene.view(int(head[14:]))
                png = depth_png(self.renderer, view, camera) if camera.whole(16) == 1 else self.renderer.png(view)
                return [struct.pack(">i", len(png)), png]
            return [b"ERROR"]
        except (ValueError, ServerError) as error:
            print(f"{head[:40].decode('ascii', 'replace')}: {error}", file=sys.stderr, flush=True)
            return [struct.pack(">i", 0), b""] if head.startswith(b"REQUEST_IMAGE_") else [b"ERROR"]


def main():
    try:
        import zmq
    except ImportError:
        sys.exit("zmq is not installed (Debian: python3-zmq)")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], epilog="Other words are those of `panwright serve`.")
    parser.add_argument("--address", default="127.0.0.1", help="to listen on (default 127.0.0.1: this machine alone); there is no password")
    parser.add_argument("--port", type=int, default=5556)
    options, words = parser.parse_known_args()
    with Renderer(words) as renderer:
        answer = renderer.lines.ask({"image": "inline", "size": [8, 8], "samples": 1})
        if not answer["ok"]:
            raise ServerError(answer)
        names = list(answer["settings"].get("pose", {}))
        with zmq.Context() as context, context.socket(zmq.REP) as wire:
            wire.setsockopt(zmq.MAXMSGSIZE, MOST_BYTES)
            wire.setsockopt(zmq.LINGER, 0)
            if options.port == 0:
                options.port = wire.bind_to_random_port(f"tcp://{options.address}")
            else:
                wire.bind(f"tcp://{options.address}:{options.port}")
            print(f"listening on tcp://{options.address}:{options.port}, spacecraft: {', '.join(names)}", flush=True)
            answers = Answers(renderer, names)
            try:
                while True:
                    while not wire.poll(200):  # a signal that comes just before zmq waits does not wake it
                        pass
                    wire.send_multipart(answers.reply(wire.recv_multipart()))
            except KeyboardInterrupt:
                pass


if __name__ == "__main__":
    main()
