"""Client of `panwright serve --json-lines`, in one file without libraries.

    with Lines(port=10363) as server:
        image = server.image({"camera": [0, -10, 0], "look-at": [0, 0, 0]})
        radiance = image["radiance"]            # memoryview; numpy.asarray(radiance) is (H, W, 3) without a copy

A view is a dict of the options of `panwright render` (docs/views.md). docs/json-lines.md has the protocol.
"""

import array
import base64
import json
import mmap
import os
import socket
import struct

PORT = 10363
FORMATS = {"float32": "f", "uint32": "I", "uint16": "H"}


class ServerError(RuntimeError):
    """An answer with errors: the first message; all are in `answer`."""

    def __init__(self, answer):
        found = [each for each in answer.get("diagnostics", []) if each["severity"] == "error"] or [{"message": "no image"}]
        super().__init__(found[0]["message"])
        self.answer = answer


class TornImage(RuntimeError):
    """The image was replaced while it was read: more images were asked for before this one was used."""


class SharedImages:
    """A segment of shared memory: images by their number, without a copy."""

    HEADER, SLOT, LAYER = struct.Struct("=8sIIQQQ"), struct.Struct("=QIIII"), struct.Struct("=24sIIQQ")

    def __init__(self, name):
        self.name = name
        file = os.open("/dev/shm/" + name.strip("/"), os.O_RDONLY)
        try:
            self.map = mmap.mmap(file, 0, prot=mmap.PROT_READ)
        finally:
            os.close(file)
        self.memory = memoryview(self.map)
        self.words = self.memory[:len(self.memory) // 8 * 8].cast("Q")
        magic, self.slots, _, self.slot_bytes, self.first, _ = self.HEADER.unpack_from(self.memory)
        if magic != b"PWIMAGE1" or self.first + self.slots * self.slot_bytes > len(self.memory):
            raise ValueError(f"{name} is no segment of images")

    def newest(self):
        """Number of the newest image; 0: none."""
        return self.words[self.HEADER.size // 8 - 1]

    def is_whole(self, number):
        """Whether an image is there, now."""
        return self.words[(self.first + number % self.slots * self.slot_bytes) // 8] == 2 * number

    def image(self, number):
        """Layers of an image by name, over the memory that the server writes: is_whole() after their use says that they were not replaced."""
        begin = self.first + number % self.slots * self.slot_bytes
        if not self.is_whole(number):
            raise TornImage(number)
        _, width, height, count, _ = self.SLOT.unpack_from(self.memory, begin)
        out = {}
        for k in range(min(count, 16)):
            name, kind, channels, offset, size = self.LAYER.unpack_from(self.memory, begin + self.SLOT.size + k * self.LAYER.size)
            shape = [height, width] + ([channels] if channels > 1 else [])
            if offset + size > self.slot_bytes or size != height * width * channels * (4, 4, 2)[kind % 3]:
                raise TornImage(number)
            out[name.rstrip(b"\0").decode()] = self.memory[begin + offset:begin + offset + size].cast("fIH"[kind % 3], shape)
        if not self.is_whole(number):
            raise TornImage(number)
        return out

    def copy(self, number):
        """Layers of an image as bytes of its own: whole, or TornImage."""
        out = {name: memoryview(bytes(layer)).cast(layer.format, layer.shape) for name, layer in self.image(number).items()}
        if not self.is_whole(number):
            raise TornImage(number)
        return out


class Lines:
    """A connection. Errors of the server are ServerError; a lost connection is ConnectionError.

    path: of a Unix socket, in place of host and port.
    """

    def __init__(self, host="127.0.0.1", port=PORT, path=None, timeout=120):
        if path is None:
            self.socket = socket.create_connection((host, port), timeout)
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        else:
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.settimeout(timeout)
            self.socket.connect(path)
        self.input = self.socket.makefile("rb", 1 << 20)
        self.shared = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.input.close()
        self.socket.close()

    def ask(self, view):
        """The answer to a view, errors and all."""
        self.socket.sendall((json.dumps(view) + "\n").encode())
        line = self.input.readline()
        if not line.endswith(b"\n"):
            self._remove_left_over()
            raise ConnectionError("the server closed the connection")
        return json.loads(line)

    def image(self, view, way="shared"):
        """Layers of a view by name: radiance, or those of its `layers`.

        way  "shared": by shared memory, without a copy; the next but one image takes its place. "inline": with the answer, from any machine.
        """
        answer = self.ask({**view, "image": way})
        if not answer["ok"]:
            raise ServerError(answer)
        if way == "inline":
            return {each["name"]: memoryview(array.array(FORMATS[each["type"]], base64.b64decode(each["base64"]))).cast("B").cast(
                FORMATS[each["type"]], each["shape"]) for each in answer["layers"]}
        if self.shared is None or self.shared.name != answer["shared"]["name"]:
            self.shared = SharedImages(answer["shared"]["name"])
        return self.shared.image(answer["shared"]["number"])

    def _remove_left_over(self):
        """The name of memory whose server was killed."""
        if self.shared is not None:
            try:
                os.unlink("/dev/shm/" + self.shared.name.strip("/"))
            except OSError:
                pass
