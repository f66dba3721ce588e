"""What adapters of other wires share: a `panwright serve --json-lines` of their own, images as PNG, rotations. Standard library alone."""

import ctypes
import math
import os
import shutil
import signal
import subprocess
import sys
import tempfile

from panwright_lines import Lines, ServerError


def end_with_parent():
    """A killed adapter leaves no server behind."""
    PR_SET_PDEATHSIG = 1
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


class Renderer:
    """A server that this process starts and ends.

    words: as after `panwright serve`: models and options. The program is that of PANWRIGHT, else of the PATH.
    """

    def __init__(self, words):
        program = os.environ.get("PANWRIGHT") or shutil.which("panwright")
        if not program:
            sys.exit("panwright is not in the PATH; set PANWRIGHT to it")
        self.folder = tempfile.TemporaryDirectory(prefix="adapter-panwright-", dir="/dev/shm" if os.path.isdir("/dev/shm") else None)
        socket = os.path.join(self.folder.name, "socket")
        os.mkdir(os.path.join(self.folder.name, "images"))
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))  # by the way of SIGINT: what was made is removed
        self.process = subprocess.Popen([program, "serve", *words, "--json-lines", "--socket", socket, "--folder",
                                         os.path.join(self.folder.name, "images")], stdout=subprocess.PIPE, text=True, preexec_fn=end_with_parent)
        if not self.process.stdout.readline():  # it says why
            self.process.wait()
            self.folder.cleanup()
            sys.exit(2)
        self.lines = Lines(path=socket)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.lines.close()
        self.process.terminate()
        self.process.wait()
        self.folder.cleanup()

    def png(self, view):
        """The bytes of the view's image. Fails: ServerError."""
        answer = self.lines.ask({**view, "output": "frame.png"})
        if not answer["ok"]:
            raise ServerError(answer)
        with open(os.path.join(self.folder.name, "images", "frame.png"), "rb") as file:
            return file.read()

    def depth(self, view):
        """Depth of the view's pixels along the boresight, rows from the top, metres; infinite: nothing. Fails: ServerError."""
        return self.lines.image({**view, "layers": ["depth"]})["depth"]


# ---- quaternions w x y z

def product(a, b):
    return [a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]]


def conjugate(q):
    return [q[0], -q[1], -q[2], -q[3]]


def unit(q):
    length = math.sqrt(sum(x * x for x in q))
    if not 1e-9 < length < math.inf:
        raise ValueError("a quaternion has no length")
    return [x / length for x in q]


def rotated(q, v):
    return product(product(q, [0, *v]), conjugate(q))[1:]


def of_mrp(sigma):
    """Of modified Rodrigues parameters."""
    square = sum(x * x for x in sigma)
    return [(1 - square) / (1 + square), *(2 * x / (1 + square) for x in sigma)]


def of_matrix(m):
    """Of a rotation matrix, nine numbers row by row."""
    trace = m[0] + m[4] + m[8]
    columns = [[1 + trace, m[7] - m[5], m[2] - m[6], m[3] - m[1]], [m[7] - m[5], 1 + 2 * m[0] - trace, m[1] + m[3], m[2] + m[6]],
               [m[2] - m[6], m[1] + m[3], 1 + 2 * m[4] - trace, m[5] + m[7]], [m[3] - m[1], m[2] + m[6], m[5] + m[7], 1 + 2 * m[8] - trace]]
    return unit(max(columns, key=lambda column: sum(x * x for x in column)))


def finite(values):
    values = list(values)
    if not all(math.isfinite(value) for value in values):
        raise ValueError("a number is not finite")
    return values
