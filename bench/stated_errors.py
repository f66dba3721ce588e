#!/usr/bin/env python3
"""Errors that images state beside their true ones, over spacecraft files: stated_errors.py PANWRIGHT FOLDER

Draws every .glb of FOLDER from several sides without light between surfaces, in the ways of MODES, and compares
flux and pixels with the path tracer (--engine reference). Prints one line a view and mode as CSV, and the share of
them whose error is above twice the stated one. Exit status: 1 if that share is above --most, 77 without files.
"""

import argparse
import array
import io
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import zipfile

MODES = {
    "imposter": ["--imposters", "always"],
    "auto": ["--imposters", "off"],
    "draft": ["--imposters", "off", "--quality", "draft"],
}
GOLDEN = math.pi * (3 - math.sqrt(5))


def run(arguments):
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    try:
        reply = json.loads(done.stdout)
    except ValueError:
        sys.exit(f"{' '.join(arguments)}: {done.stderr}")
    if done.returncode != 0:
        sys.exit(f"{' '.join(arguments)}: {reply['diagnostics']}")
    return reply


def layer(path, name):
    with zipfile.ZipFile(path) as archive:
        data = io.BytesIO(archive.read(name + ".npy"))
    assert data.read(6) == b"\x93NUMPY"
    data.read(2)
    header = data.read(int.from_bytes(data.read(2), "little")).decode()
    assert "'<f4'" in header, header
    values = array.array("f")
    values.frombytes(data.read())
    return values


def direction(i, count):
    """The i-th of directions that cover the sphere evenly."""
    z = 1 - 2 * (i + 0.5) / count
    r = math.sqrt(1 - z * z)
    return [r * math.cos(GOLDEN * i), r * math.sin(GOLDEN * i), z]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def views_of(radius, centre, count, size):
    """The whole spacecraft, at phase angles of 15 to 120 degrees in turn about both sides."""
    views = []
    for i in range(count):
        to_camera = direction(i, count)
        across = cross(to_camera, [0.26726, 0.53452, 0.80178])
        length = math.sqrt(sum(x * x for x in across))
        phase = math.radians(15 + 105 * ((7 * i) % count) / max(count - 1, 1)) * (-1) ** i
        views.append({
            "camera": [c + 6 * radius * d for c, d in zip(centre, to_camera)],
            "look-at": centre,
            "fov": 2 * math.degrees(math.asin(1.05 / 6)),
            "sun": [math.cos(phase) * d + math.sin(phase) * a / length for d, a in zip(to_camera, across)],
            "size": size,
        })
    return views


def draw(program, model, views, folder, name, options):
    listed = [dict(view, output=str(folder / f"{name}{i}.npz")) for i, view in enumerate(views)]
    file = folder / f"{name}.json"
    file.write_text(json.dumps(listed))
    images = run([program, "render", str(model), "--views", str(file), "--json", *options])["images"]
    return [(image, folder / f"{name}{i}.npz") for i, image in enumerate(images)]


def stated(image):
    """Relative errors of flux and pixels (none: no statement)."""
    if image.get("imposters"):
        return max(one["flux_error"] for one in image["imposters"]), None
    return image.get("flux_error"), image.get("pixel_error")


def compared(path, truth_path):
    """True relative errors of flux and pixels, and what of the latter the path tracer's noise is."""
    drawn, truth, errors = layer(path, "radiance"), layer(truth_path, "radiance"), layer(truth_path, "standard_error")
    total = sum(truth)
    squares = sum(t * t for t in truth)
    # the path tracer's own noise is not an error of the image
    noise = sum(e * e for e in errors)
    apart = sum((d - t) ** 2 for d, t in zip(drawn, truth)) - noise
    return sum(drawn) / total - 1, math.sqrt(max(apart, 0) / squares), math.sqrt(noise / squares)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--views", type=int, default=12)
    parser.add_argument("--size", type=int, default=96)
    parser.add_argument("--samples", type=int, default=65536, help="a pixel of the path tracer, at most")
    parser.add_argument("--known", default="0.2%", help="the path tracer's error, unless it ends by --samples")
    parser.add_argument("--modes", default=",".join(MODES))
    parser.add_argument("--most", type=float, default=0.05)
    parser.add_argument("--only", default="", help="files whose names hold this, comma separated")
    given = parser.parse_args()
    words = given.only.split(",")
    files = sorted(f for f in given.folder.glob("*.glb") if any(word in f.name for word in words))
    if not files:
        return 77
    modes = {mode: MODES[mode] for mode in given.modes.split(",")}
    counts = {mode: [0, 0] for mode in modes}
    print("file,view,mode,flux_error,stated_flux_error,rms_error,stated_rms_error,known_to")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        model = folder / "model.pan"
        for file in files:
            if subprocess.run([given.program, "import", str(file), "-o", str(model), "-q"], check=False).returncode:
                continue
            bounds = run([given.program, "info", str(model), "--json"])["bounds"]
            low, high = bounds["min"], bounds["max"]
            views = views_of(0.5 * math.dist(low, high), [0.5 * (a + b) for a, b in zip(low, high)], given.views,
                             given.size)
            truths = draw(given.program, model, views, folder, "truth",
                          ["--engine", "reference", "--bounces", "0", "--until-error", given.known, "--max-samples",
                           str(given.samples)])
            for mode, options in modes.items():
                for i, (image, path) in enumerate(draw(given.program, model, views, folder, mode, options)):
                    known = max(e / f for e, f in zip(truths[i][0]["flux_error"], truths[i][0]["flux"]))
                    flux, rms, noise = compared(path, truths[i][1])
                    says_flux, says_rms = stated(image)
                    counts[mode][1] += 1
                    # twice what the image and the path tracer state
                    wrong = abs(flux) > 2 * (says_flux or 0) + 2 * known  # no statement states 0
                    # of pixels nothing is known below the noise of theirs, whose tails are wide
                    wrong = wrong or (says_rms is not None and noise < 0.5 * says_rms and rms > 2 * says_rms)
                    counts[mode][0] += wrong
                    print(f"{file.stem},{i},{mode},{flux:.3g},{says_flux},{rms:.3g},{says_rms},{known:.2g}"
                          f"{',WRONG' if wrong else ''}", flush=True)
    good = True
    for mode, (wrong, all_) in counts.items():
        print(f"{mode}: {wrong} of {all_} views have an error above twice the stated one", file=sys.stderr)
        good = good and wrong <= given.most * all_
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
