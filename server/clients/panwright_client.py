"""Client of `panwright serve` and other servers of the PANGU protocol, in one file without libraries.

    with Client() as server:
        server.set_viewpoint((0, -10, 0), (0.7071, -0.7071, 0, 0))
        width, height, pixels = read_ppm(server.image())

Metres, radians; world_from_camera quaternions w x y z, camera x right, y down, z forward. docs/server.md has the protocol.
"""

import socket
import struct

PORT = 10363
VERSION = 0x114  # 1.20


class ServerError(RuntimeError):
    """An error reply: code and text."""

    def __init__(self, code, text):
        super().__init__(f"{text} ({code})")
        self.code = code


def pack_float(value):
    """A float: its IEEE word turned left by 9 bits."""
    word, = struct.unpack(">I", struct.pack(">f", value))
    return struct.pack(">I", (word << 9 | word >> 23) & 0xFFFFFFFF)


def unpack_float(data):
    word, = struct.unpack(">I", data)
    return struct.unpack(">f", struct.pack(">I", (word >> 9 | word << 23) & 0xFFFFFFFF))[0]


def pack_double(value):
    """A double: its IEEE word turned left by 12 bits, the low half first."""
    word, = struct.unpack(">Q", struct.pack(">d", value))
    word = (word << 12 | word >> 52) & 0xFFFFFFFFFFFFFFFF
    return struct.pack(">II", word & 0xFFFFFFFF, word >> 32)


def unpack_double(data):
    low, high = struct.unpack(">II", data)
    word = high << 32 | low
    return struct.unpack(">d", struct.pack(">Q", (word >> 12 | word << 52) & 0xFFFFFFFFFFFFFFFF))[0]


class Client:
    """A session. Errors of the server are ServerError; a lost connection is ConnectionError."""

    def __init__(self, host="127.0.0.1", port=PORT, timeout=120):
        self.socket = socket.create_connection((host, port), timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.sendall(struct.pack(">I", VERSION))
        self._expect(0)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Says goodbye."""
        try:
            self.socket.sendall(struct.pack(">I", 0))
        except OSError:
            pass
        self.socket.close()

    # ---- the camera

    def set_viewpoint(self, position, quaternion):
        self._command(269, *position, *quaternion)

    def set_viewpoint_by_degrees(self, position, yaw, pitch, roll):
        self._command(268, *position, yaw, pitch, roll)

    def set_field_of_view(self, radians):
        self._send(279, pack_float(radians))
        self._expect(0)

    # ---- the world

    def set_object(self, number, position, quaternion):
        self._send(270, struct.pack(">I", number), *map(pack_double, (*position, *quaternion)))
        self._expect(0)

    def set_sun(self, azimuth, elevation, distance=149597870700.0):
        self._command(280, distance, azimuth, elevation)

    def joints(self, number):
        """Joints of an object: (id, name, type), type 0 general, 1 revolute, 2 prismatic."""
        self._send(18, struct.pack(">I", number))
        self._expect(14)
        return [(self._word(), self._text(), self._word()) for _ in range(self._word())]

    def set_joint(self, number, joint, *values):
        """Sets the first values: radians, metres, factors."""
        values = [(value, 1) for value in values] + [(0, 0)] * (9 - len(values))
        self._send(272, struct.pack(">III", number, joint, 9), *(pack_double(value) + bytes([mark]) for value, mark in values))
        self._expect(0)

    # ---- measurements

    def image(self):
        """The bytes of an image file: PPM, PFM or raw, as the server was started."""
        self._send(1)
        self._expect(2)
        return self._read(self._word())

    def points(self, pixels):
        """World points under image places, from (0, 0) lower left to (1, 1) upper right; None where nothing is."""
        self._send(5, struct.pack(">I", len(pixels)), *(pack_float(number) for pixel in pixels for number in pixel))
        self._expect(6)
        data = self._read(13 * self._word())
        return [tuple(unpack_float(data[at + k:at + k + 4]) for k in (0, 4, 8)) if data[at + 12] else None
                for at in range(0, len(data), 13)]

    def pulse(self, position, direction):
        """Range along a ray, and the cosine of the incidence angle; 0 0: nothing is hit."""
        self._send(13, *map(pack_float, (*position, *direction)))
        self._expect(9)
        return unpack_float(self._read(4)), unpack_float(self._read(4))

    # ---- the wire

    def _command(self, number, *values):
        self._send(number, *map(pack_double, values))
        self._expect(0)

    def _send(self, number, *fields):
        self.socket.sendall(struct.pack(">I", number) + b"".join(fields))

    def _read(self, count):
        data = bytearray(count)
        view = memoryview(data)
        while view:
            got = self.socket.recv_into(view)
            if got == 0:
                raise ConnectionError("the server closed the connection")
            view = view[got:]
        return bytes(data)

    def _word(self):
        return struct.unpack(">I", self._read(4))[0]

    def _text(self):
        return self._read(struct.unpack(">H", self._read(2))[0]).split(b"\0")[0].decode()

    def _expect(self, code):
        got = self._word()
        if got == 1:
            number, = struct.unpack(">i", self._read(4))
            raise ServerError(number, self._text())
        if got != code:
            raise ConnectionError(f"reply {got}, expected {code}")


def read_ppm(data):
    """Width, height and pixels of a PPM or PGM of 8 bits."""
    magic, width, height, most = data.split(maxsplit=4)[:4]
    if magic not in (b"P5", b"P6") or most != b"255":
        raise ValueError("expected a PPM or PGM of 8 bits")
    count = int(width) * int(height) * (3 if magic == b"P6" else 1)
    return int(width), int(height), data[-count:]
