#!/usr/bin/env python3
"""Adapters for clients of CORTO and of Basilisk's vizInterface, by clients written from their public descriptions. adapters_test.py PANWRIGHT SOURCE_DIR

Images are those of `render` at poses that are computed here, by matrices. Without zmq the second is left out, and it says so.
"""

import atexit
import json
import math
import os
import socket
import struct
import subprocess
import sys
import tempfile
import zlib

try:
    import numpy as np
except ImportError as missing:
    print(missing)
    sys.exit(77)

PROGRAM, SOURCE = map(os.path.abspath, sys.argv[1:3])
CLIENTS = os.path.join(SOURCE, "server", "clients")
OPTIONS = ["--engine", "reference", "--samples", "2", "--size", "40x30", "--fov", "30"]
SCENE = """<pangu_model ver="1" units="m">
  <node name="body"><box size="2 1 1.5"/></node>
  <node name="mast"><box size="0.3 0.3 1" translate="0.6 0 1.2"/></node>
</pangu_model>
"""


def expect(condition, what):
    if not condition:
        raise SystemExit(f"adapters_test: {what}")


def pixels(png):
    """Numbers of a PNG of 8 bits, (H, W, channels), by its specification."""
    expect(png[:8] == b"\x89PNG\r\n\x1a\n", png[:20])
    at, data = 8, b""
    while at < len(png):
        size, kind = struct.unpack_from(">I4s", png, at)
        body = png[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack_from(">IIBB", body)
        elif kind == b"IDAT":
            data += body
        at += 12 + size
    expect(bits == 8, bits)
    channels = {0: 1, 2: 3, 6: 4}[color]
    raw, row = zlib.decompress(data), np.zeros(width * channels, int)
    out = []
    for y in range(height):
        begin = y * (width * channels + 1)
        kind, line = raw[begin], np.frombuffer(raw, np.uint8, width * channels, begin + 1).astype(int)
        above, row = row, np.zeros_like(line)
        for i in range(len(line)):
            left = row[i - channels] if i >= channels else 0
            up, corner = above[i], above[i - channels] if i >= channels else 0
            nearest = min((left, up, corner), key=lambda each: abs(left + up - corner - each))
            row[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[kind]) & 255
        out.append(row)
    return np.array(out).reshape(height, width, channels)


def start(name, words):
    process = subprocess.Popen([sys.executable, os.path.join(CLIENTS, name), *words, *OPTIONS], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               text=True, env={**os.environ, "PANWRIGHT": PROGRAM, "PYTHONDONTWRITEBYTECODE": "1"})
    atexit.register(process.terminate)
    line = process.stdout.readline()
    expect(line, process.stderr.read() if not line else "")
    return process, line


def rendered(view, models, *options):
    view = {**view, "output": "expected.png"}
    with open("views.json", "w", encoding="utf-8") as file:
        json.dump([view], file)
    done = subprocess.run([PROGRAM, "render", *models, *OPTIONS, "--views", "views.json", *options], capture_output=True, text=True)
    expect(done.returncode == 0, done.stderr)
    with open("expected.png", "rb") as file:
        return pixels(file.read())


def quaternion(axis, angle):
    axis = np.array(axis) / np.linalg.norm(axis)
    return [math.cos(angle / 2), *(math.sin(angle / 2) * axis)]


def matrix(q):
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def of_matrix(m):
    """By its eigenvector; the sign is free."""
    k = np.array([[m[0, 0] - m[1, 1] - m[2, 2], 0, 0, 0], [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], 0, 0],
                  [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], 0],
                  [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]]]) / 3
    x, y, z, w = np.linalg.eigh(k)[1][:, 3]
    return [float(v) for v in (w, x, y, z)]


def looking(position, target, up):
    """world_from_camera with z forward, y down."""
    z = np.array(target, float) - position
    z /= np.linalg.norm(z)
    x = np.cross(z, up)
    x /= np.linalg.norm(x)
    return np.array([x, np.cross(z, x), z]).T


def same(png, expected, what):
    got = pixels(png)
    expect(got.shape == expected.shape and expected.max() > 60 and (expected == 0).any(), (what, got.shape, expected.shape))
    # poses are rounded in other places: measured 0
    expect(np.abs(got - expected).max() <= 1, f"{what}: {np.abs(got - expected).max()} levels")


def corto():
    process, line = start("panwright_corto.py", ["--pose-port", "0", "--image-port", "0", "--scale", "2", "craft.pxn", "tug=craft.pxn"])
    pose_port, image_port = int(line.split("127.0.0.1:")[1].split(",")[0]), int(line.split("TCP ")[1].split(",")[0])
    expect("craft, tug" in line, line)
    wire, poses = socket.create_connection(("127.0.0.1", image_port), 30), socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def image(values):
        poses.sendto(values if isinstance(values, bytes) else struct.pack(f">{len(values)}d", *values), ("127.0.0.1", pose_port))
        size, = struct.unpack("<Q", exactly(wire, 8))
        return exactly(wire, size)

    camera = np.array([-3.0, -4, 1.5])
    ours = looking(2 * camera, [0, 0, 0], [0, 0, 1])
    blender = ours @ np.diag([1, -1, -1])  # x right, y up, looks along -z
    first, second = quaternion([0, 0, 1], 0.7), quaternion([1, 0.3, 0], -0.4)
    values = [-30.0, -20, 15, *camera, *of_matrix(blender), 0.1, 0, 0.05, *first, 1, 0.2, -0.3, *second]
    expected = rendered({"camera": list(2 * camera), "quat": of_matrix(ours), "sun": [-30.1, -20, 14.95],
                         "pose": {"craft": [0.2, 0, 0.1, *first], "tug": [2, 0.4, -0.6, *second]}}, ["craft.pxn", "tug=craft.pxn"])
    same(image(values), expected, "a pose of CORTO")
    same(image(values[:3] + [1, 0, 0, 0] + values[3:]), expected, "a pose with a quaternion of the Sun")
    for wrong in (b"", b"12345", struct.pack(">5d", *range(5)), struct.pack(">24d", *[math.nan] * 24), struct.pack(">24d", *[0] * 24)):
        expect(image(wrong) == b"", "a wrong packet has an empty answer")
    same(image(values), expected, "a pose after wrong ones")
    wire.close()
    wire = socket.create_connection(("127.0.0.1", image_port), 30)
    same(image(values), expected, "another client")
    end(process)


def exactly(wire, count):
    out = b""
    while len(out) < count:
        part = wire.recv(count - len(out))
        expect(part, "the connection ended")
        out += part
    return out


def end(process):
    process.terminate()
    expect(process.wait(20) == 0, "an adapter ends cleanly")
    expect(not [name for name in os.listdir("/dev/shm") if name.startswith("adapter-panwright-")], "nothing is left in memory")


# ---- protocol buffers, as vizMessage.proto numbers the fields

def field(number, value):
    def whole(n):
        out = b""
        while n > 127:
            out, n = out + bytes([n & 127 | 128]), n >> 7
        return out + bytes([n])
    if isinstance(value, int):
        return whole(number << 3) + whole(value)
    if isinstance(value, float):
        return whole(number << 3 | 1) + struct.pack("<d", value)
    if isinstance(value, str):
        value = value.encode()
    if not isinstance(value, bytes):
        value = struct.pack(f"<{len(value)}d", *value)
    return whole(number << 3 | 2) + whole(len(value)) + value


def mrp(rotation):
    """Of the rotation from N to B as a matrix, by its principal axis: e tan(angle/4)."""
    w, x, y, z = of_matrix(rotation.T)  # the active rotation
    if w < 0:
        w, x, y, z = -w, -x, -y, -z
    return [value / (1 + w) for value in (x, y, z)]


def vizard():
    import zmq
    process, line = start("panwright_vizard.py", ["--port", "0", "client=craft.pxn", "tug=craft.pxn"])
    expect("client, tug" in line, line)
    context = zmq.Context()
    atexit.register(context.destroy, linger=0)
    wire = context.socket(zmq.REQ)
    wire.setsockopt(zmq.RCVTIMEO, 60000)
    wire.connect(line.split()[2].rstrip(","))

    def ask(*parts):
        wire.send_multipart(parts)
        return wire.recv_multipart()

    def image(number):
        size, png = ask(f"REQUEST_IMAGE_{number}".encode())
        expect(struct.unpack(">i", size)[0] == len(png), "the length of an image")
        return png

    expect(len(ask(b"PING")) == 1, "a ping")
    expect(image(1) == b"", "an image before the first message")
    servicer = np.array([7e6, 1e5, -2e5])
    client = servicer + [3.0, 5, 1]
    to_body = matrix(quaternion([0.2, 1, 0.3], 0.6)).T  # [BN] of the servicer
    to_client = matrix(quaternion([1, 0, 0.5], -0.9)).T
    position_in_body = np.array([0.4, 0.1, -0.2])
    eye = to_body.T @ position_in_body
    ours = looking(eye, client - servicer, [0, 0, 1])  # N_from_camera
    # Vizard's camera looks along -x, z up, y completes it
    vizard_camera = np.array([-ours[:, 2], np.cross(-ours[:, 1], -ours[:, 2]), -ours[:, 1]]).T  # N_from_Cu
    camera_from_body = (to_body @ vizard_camera).T
    message = field(1, field(1, 7))
    message += field(2, field(1, "sun_planet_data") + field(2, servicer + np.array([1e11, -0.6e11, 0.4e11])) + field(4, np.eye(3).ravel()))
    message += field(2, field(1, "blob") + field(2, servicer + 4e3 * (client - servicer)) + field(4, np.eye(3).ravel()) + field(6, 1.5))
    message += field(3, field(1, "servicer") + field(2, servicer) + field(4, mrp(to_body)))
    message += field(3, field(1, "client") + field(2, client) + field(4, mrp(to_client)))
    cameras = (field(1, 1) + field(2, "servicer") + field(3, 20.0) + field(4, bytes([48, 36])) + field(7, position_in_body) + field(8, mrp(camera_from_body)),
               field(1, 2) + field(2, "servicer") + field(3, 20.0) + field(4, 48) + field(4, 36) + field(7, position_in_body) +
               field(8, mrp(camera_from_body)) + field(16, 1) + field(17, [4.0, 8.0]))
    for camera in cameras:
        message += field(4, camera)
    expect(ask(b"SIM_UPDATE", b"", b"", message) == [b"OK"], "an update")
    expect(ask(b"REQUEST_INPUT")[0] == b"VIZARD_INPUT", "the user's input")
    across = math.degrees(2 * math.atan(48 / 36 * math.tan(math.radians(10))))
    view = {"camera": list(eye), "quat": of_matrix(ours), "fov": across, "size": [48, 36], "sun": [1, -0.6, 0.4],
            "pose": {"client": [*(client - servicer), *of_matrix(to_client.T)]},
            "planet": {"blob": "{} {} {} radius=1500".format(*(4e3 * (client - servicer)))}}
    expected = rendered(view, ["client=craft.pxn"])
    same(image(1), expected, "an image for Basilisk")
    depth = pixels(image(2))[:, :, 0]
    subprocess.run([PROGRAM, "render", "client=craft.pxn", *OPTIONS[:4], "--views", "views.json"], check=True, capture_output=True)
    with open("views.json", "w", encoding="utf-8") as file:
        json.dump([{**{key: value for key, value in view.items() if key != "planet"}, "output": "depth.npz"}], file)
    subprocess.run([PROGRAM, "render", "client=craft.pxn", *OPTIONS, "--views", "views.json"], check=True, capture_output=True)
    true = np.clip((np.load("depth.npz")["depth"].reshape(36, 48) - 4) / 4, 0, 1) * 255
    expect((true < 200).sum() > 50 and np.abs(depth - true).max() <= 0.51, f"depth: {np.abs(depth - true).max()} levels")
    for parts in ((b"NONSENSE",), (b"SIM_UPDATE", b"", b"", b"\xff\xff\xff"), (b"SIM_UPDATE", b"", b"", field(3, field(1, "client") + field(2, [1.0])))):
        expect(ask(*parts) == [b"ERROR"], parts)
    expect(image(9) == b"" and pixels(image(1)).shape == (36, 48, 3), "after wrong messages")
    wire.close(0)
    end(process)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        with open("craft.pxn", "w", encoding="utf-8") as file:
            file.write(SCENE)
        corto()
        try:
            import zmq  # noqa: F401
        except ImportError:
            print("without zmq: Basilisk's interface is not tested")
        else:
            vizard()
        os.chdir("/")


main()
