#!/usr/bin/env python3
"""The four operations of the paper, once more, with numpy: prints what tests/mli/level0_test.cpp
expects. Written from docs/conventions.md 11 and the Philox paper alone; needs numpy.

    level0.py        the checksums of the sheets of SHEETS
"""
import numpy as np

SHEETS = [
    # width, height, xgrid, seed, operations
    (120.0, 60.0, 240, 0, [("random", 1.0), ("smooth", 4), ("constant", 4.0),
                           ("taper", 5.0, 7.0, 2.5, 3.5)]),
    (1.0, 0.7, 37, 4294967295, [("random", 0.003)]),
    (0.31, 1.0, 61, 12345, [("constant", 0.1), ("random", 0.02), ("smooth", 1), ("random", 0.01),
                            ("smooth", 19), ("taper", 0.0, 0.0, 0.1, 0.35)]),
    (2.0, 0.01, 200, 7, [("random", 1.0), ("smooth", 3)]),
]


def philox(counter, key):
    """Philox4x32-10 of arrays of counters."""
    mask = np.uint64(0xFFFFFFFF)
    c = [np.asarray(word, dtype=np.uint64) for word in counter]
    k = [int(word) for word in key]
    for _ in range(10):
        first, second = np.uint64(0xD2511F53) * c[0], np.uint64(0xCD9E8D57) * c[2]
        c = [(second >> np.uint64(32)) ^ c[1] ^ np.uint64(k[0]), second & mask,
             (first >> np.uint64(32)) ^ c[3] ^ np.uint64(k[1]), first & mask]
        k = [(k[0] + 0x9E3779B9) & 0xFFFFFFFF, (k[1] + 0xBB67AE85) & 0xFFFFFFFF]
    return c


def uniform(rows, columns, seed, operation):
    """Numbers in (-1, 1): the middles of 2^32 equal steps."""
    j, i = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    zero = np.zeros_like(i)
    words = np.stack(philox((i // 4, j, zero, zero), (seed, operation)))
    word = np.take_along_axis(words, (i % 4)[None].astype(np.int64), 0)[0]
    return (2 * word.astype(np.float64) + 1 - 2.0**32) / 2.0**32


def smoothed(h, axis):
    padded = np.pad(h, [(1, 1) if k == axis else (0, 0) for k in range(2)], mode="edge")
    before = np.take(padded, np.arange(h.shape[axis]), axis)
    after = np.take(padded, np.arange(h.shape[axis]) + 2, axis)
    return h + ((before - h) + (after - h)) * (1.0 / 3.0)


def ramp(count, cell, zero, full):
    i = np.arange(count)
    inside = np.minimum(i, count - 1 - i) * cell
    with np.errstate(invalid="ignore", divide="ignore"):
        t = np.clip((inside - zero) / (full - zero), 0, 1)
    return np.where(inside >= full, 1.0, t * t * (3 - 2 * t))


def sheet(width, height, xgrid, seed, operations):
    cell = width / xgrid
    h = np.zeros((int(np.floor(height / width * xgrid + 0.5)) + 1, xgrid + 1))
    for index, (name, *numbers) in enumerate(operations):
        if name == "random":
            h = h + numbers[0] * uniform(*h.shape, seed, index)
        elif name == "constant":
            h = h + numbers[0]
        elif name == "smooth":
            for _ in range(numbers[0]):
                h = smoothed(smoothed(h, 1), 0)
        else:
            x = ramp(h.shape[1], cell, *numbers[:2])
            h = h * (x[None, :] * ramp(h.shape[0], cell, *numbers[2:])[:, None])
    return h


def checksum(h):
    total = 14695981039346656037
    for word in h.astype("<f8").view("<u8").ravel().tolist():
        total = (total ^ word) * 1099511628211 % 2**64
        total ^= total >> 32
    return total


if __name__ == "__main__":
    for recipe in SHEETS:
        print(f"0x{checksum(sheet(*recipe)):016x}")
