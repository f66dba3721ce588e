#!/usr/bin/env python3
"""Writes data/opencv.txt: where OpenCV puts directions, on 1,000 random lenses of each of its two models.

    make_opencv_table.py          writes it
    make_opencv_table.py --check  compares it with the OpenCV at hand, to 1e-12

Needs python3-opencv; the table is committed, so that tests do not. Coefficients follow from numbers that
lens_test.cpp makes in the same way; the table holds the results, in focal lengths.
"""

import pathlib
import sys

import cv2
import numpy

LENSES = 1000
# largest coefficient of each term, in OpenCV's order
BROWN = [0.3, 0.2, 5e-3, 5e-3, 0.1, 0.1, 0.1, 0.05, 5e-3, 5e-3, 5e-3, 5e-3, 0.05, 0.05]
FISHEYE = [0.05, 0.02, 0.01, 0.005]


class Numbers:
    """SplitMix64, as numbers from -1 to 1."""

    def __init__(self):
        self.state = 0

    def next(self):
        mask = (1 << 64) - 1
        self.state = (self.state + 0x9E3779B97F4A7C15) & mask
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        return ((z ^ (z >> 31)) >> 11) * 2.0**-52 - 1


def main():
    numbers = Numbers()
    zero = numpy.zeros(3)
    lines = []
    for _ in range(LENSES):
        k = numpy.array([most * numbers.next() for most in BROWN])
        point = numpy.array([[[0.5 * numbers.next(), 0.5 * numbers.next(), 1.0]]])
        x, y = cv2.projectPoints(point, zero, zero, numpy.eye(3), k)[0].ravel()
        lines.append((float(x), float(y)))
    for _ in range(LENSES):
        k = numpy.array([most * numbers.next() for most in FISHEYE])
        point = numpy.array([[[1.2 * numbers.next(), 1.2 * numbers.next(), 1.0]]])
        x, y = cv2.fisheye.projectPoints(point, zero, zero, numpy.eye(3), k)[0].ravel()
        lines.append((float(x), float(y)))
    path = pathlib.Path(__file__).parent / "data/opencv.txt"
    if sys.argv[1:] == ["--check"]:
        worst = numpy.abs(numpy.loadtxt(path) - numpy.array(lines)).max()
        print(f"OpenCV {cv2.__version__}: {len(lines)} places within {worst:.2g} focal lengths")
        return 0 if worst <= 1e-12 else 1
    path.write_text("".join(f"{x!r} {y!r}\n" for x, y in lines), encoding="utf-8")
    return 0


sys.exit(main())
