#!/usr/bin/env python3
"""Writes docs/accuracy.md and its curves from bench/results (accuracy, error_bars, glint, imposters, imposters_craft, moments, wide), or with --check says whether they are as it would write them."""

import csv
import pathlib
import re
import sys

import curves

ROOT = pathlib.Path(__file__).resolve().parent.parent

INTRO = """# How right is the preview?

The OpenGL preview against the reference renderer ([reference renderer](reference-renderer.md)), BRDF by BRDF: a sphere that fills nine tenths of the
image, and the servicer of the examples with every surface of that BRDF; 256 × 256 pixels, 4 × 4 points each, the Sun 60° (sphere)
and 56° (servicer) from the line of sight. This page is written by `bench/accuracy_table.py` from `bench/results/accuracy.csv`, which
`panwright-bench accuracy` measures, and from `glint.csv`, `moments.csv`, `wide.csv` and `error_bars.csv`.

- **flux**: relative error of the sum of the whole image, the strongest channel.
- **RMSE**: root of the mean square of π·ΔL over all pixels, both clipped at white (1).
- **FLIP**: how visible the difference is when one flips between the two images, 0 to 1, mean (Andersson and others 2020).
- **±**: one standard error of the reference, which the preview's error cannot be told from below. That of RMSE is the RMS of what its pixels
  state, which is up to a fifth more than the true one.

"""

SIDES = """## Twelve sides of the servicer

The servicer as authored, seen from the corners of an icosahedron at 15.3 m with a field of view of 24°; columns as above. Near a phase of 180° little of what is
seen is lit: the errors there are those of few pixels.

| from | phase | flux | ± | RMSE | ± | FLIP | ms a frame |
|---|---|---|---|---|---|---|---|
"""

FAR = """## Targets of any size: error, speed and range

A Lambert sphere at a phase of 60° against closed forms, in 1024 × 1024 pixels, over shifts of the grid of pixels (rms); times are those of whole images with OSMesa on two cores, read back. *Cropped*: by a camera
that sees the sphere's own pixels alone. `panwright-bench imposters` and `imposters_craft` measure them; the same on a GPU stand in `bench/results/h100`.

![flux error over the radius](images/far-flux.svg)

![flux error over the time](images/far-speed.svg)

"""

CRAFT = """
The servicer with the finest foil, on an approach from 1,000 km to 2.8 m, against an image of a thousand pixels with 8 × 8 samples each, nearer than 20 m of as many with 16 × 16, and shadow maps of 8,192 texels (twice as many samples a side change less than 1e-4). With `--flux-error 0.05%` imposters end at 511 pixels,
where samples to `--pixel-error 5%` take over: right to 2 % in the pixels, and up to 0.1 % too dark ([why](accuracy/imposters.md)).

![flux error over the range](images/far-range.svg)

"""

BARS = """
## Error bars of the reference

How right the standard error is that the reference states for each pixel ([formula](accuracy/reference-renderer.md#error-bars)), with few samples: 48 × 48 pixels, three bounces, the disc of the Sun, 16
to 64 seeds each against 4096 samples of another seed. Of pixels with any light: the share within three standard errors (99 % are
wanted), and the mean stated error over the mean true one, the RMS of the seeds (at most 1.5 is wanted). Written from `bench/results/error_bars.csv`, which
`panwright-bench error_bars` measures.

"""

WIDE = """## Shadows in wide models

A cube of 10 cm on a plate, seen from 1.2 m with a field of view of 25°, and a deck of 120 m with a rail on posts, seen along it: a shadow map
consists of tiles where one map of the whole model would be too coarse ([conventions](conventions-models.md) 13). 256 × 256 pixels, 4 × 4 points each, against the
reference renderer without disc and bounces; RMSE over the RMS of the image, of which the edges of shadows are nearly all. Times are those
of 1024 × 1024 pixels with a map drawn anew, beside the first line's. `panwright-bench wide` measures them.

| model | flux | RMSE | ± | ms a frame | ratio |
|---|---|---|---|---|---|
"""

NOTES = """
## What the preview leaves out

- Light between surfaces ("with light between surfaces" above has three bounces in the reference). A concave spacecraft gets
  more light than the preview shows: 7.5 % of the servicer, up to 16 % of Landsat 8 and 44 % of Hubble.
- With `--samples N`, unless `--shadows soft`: the half shadow at the edges of shadows, 9.3 mm wide for each metre between caster and receiver ([shadows](shadows.md)).
- Lobes wider than a slope of 0.15 (GGX: 0.2) are those of a point Sun, from 0.98 AU on: 2 % of their peak at 85°, 0.1 % at normal incidence. Mirrored light at 88°, 89° and 89.5° is 1.05, 1.19 and 1.74 times too bright for a slope of 0.15 (Beckmann).
- Retroreflectors: their lobe is the mean over the Sun's disc of a Gaussian; what depends on the angle of incidence is taken at the disc's centre.
"""


GLINT = """## Glints

A flat plate with one narrow lobe, the Sun's disc on it: views in the plane of incidence and across it, 1° about the specular direction, against a
quadrature over the disc of the BRDFs as the papers print them (`tests/support/disc_quadrature.h`). The worst of slopes 0.001, 0.003, 0.01, 0.03 and 0.1 at 0°,
30°, 60°, 75° and 85°; **integral**: over the whole image, slopes 0.001 and 0.01 at 0° and 75°. `panwright-bench glint` measures it.

"""

PRECISION = """
### Single precision

The largest relative error of the formulas in single precision against the same in double under the Sun's disc at 1 AU, near the glint, where
they are above 1e-6 of its peak, by the largest angle of incidence. `panwright material` measures a material's own, up to 89.9°.

"""


MOMENTS = """## Normal maps seen from afar

A plate with a normal map of 128 × 128 texels whose bumps are smaller than a pixel: Gaussian ones (3 texels), such as are four times as long as wide, and grooves of a
sine's profile, 16 texels wide. Slopes: rms along the steeper axis. The levels of a normal map hold the mean normal and the covariance of the slopes beneath; each lobe
becomes wider by twice that, along the bumps' own axes. Relative error of the flux, rms over phase angles of 0°, 45° and 90° (and at 120°) and three positions of the
bisector (0°, 8° and 15° from the normal), against the mean over the map's texels, each facet as large as it looks, without shadows and light between facets; mean over 12 seeds on
both sides. **one number**: as it was with one isotropic slope for each texel. `panwright-bench moments` measures it (`moments.csv`, and `moments_isotropic.csv` by
the program before; two cores shared with other work: times say little).

"""

MOMENTS_NOTES = """
- Bumps as a Gaussian has them are right within a few per cent where a pixel spans several of them. Where it spans about one (8 texels a pixel above), each
  pixel takes the covariance of a sample for that of the bumps, and the peak is too bright.
- Where isotropic bumps are smaller than a Blinn-Phong lobe its far flank is up to 10 % too dark (worst 3 % before), and Cook-Torrance over isotropic slopes of 0.2 and more is 0.5 to 1.2 % less right
  than before, rms: beside grooves at 120° under a brushed GGX the only rows that became worse by more than 0.3 %.
- Grooves and ridges of few slopes are no Gaussian: across them the peak is too bright and the flanks too dark as soon as slopes exceed the material's own, and no covariance can say it.
- Diffuse light takes the length of the mean normal, as the reference renderer's flat plates do: what facets show more of than the plate is missing (σ²·tan·tan: 13 % at a phase
  of 120° and slopes of 0.2).
- A coat's peak becomes wider by the bumps as seen, what lies below it by what a refracted beam sees of them: both tilt as one. The coat's Fresnel terms are those of the mean normal.
"""


def moments():
    table = {}
    for column, case in enumerate(("moments_isotropic", "moments")):
        for row in rows(case):
            setting, phase = row["setting"].split(", phase ")
            phase, worst = phase.split("; worst ")
            cell = table.setdefault(setting.removesuffix(" texels a pixel"), {})
            cell[phase, column] = (float(row["error"]), float(worst.split()[0]))
    out = MOMENTS + ("| bumps | slope | material | texels a pixel | one number | worst | covariance | worst | at 120°: one number | covariance |\n"
                     "|---|---|---|---|---|---|---|---|---|---|\n")
    for setting, cells in table.items():
        bumps, rest = setting.split(" slope ")
        slope, rest = rest.split(" ", 1)
        material, texels = rest.rsplit(" ", 1)
        out += f"| {bumps} | {slope} | {material} | {texels} |"
        for column in (0, 1):
            error, worst = cells["0 to 90", column]
            out += f" {100 * error:.1f} % | {worst:.0f} % |"
        out += "".join(f" {100 * cells['120', column][0]:.0f} % |" for column in (0, 1)) + "\n"
    return out + MOMENTS_NOTES + "\n"


def glint():
    plates, precision = {}, {}
    for row in rows("glint"):
        name = row["setting"].split("; ")
        if name[0] == "precision":
            precision.setdefault((name[1], name[2]), []).append(float(row["error"]))
        else:
            plates.setdefault(tuple(name), {})[row["error_unit"].split(",")[0]] = float(row["error"])
    out = GLINT + "| BRDF | Sun | limb darkening | peak | profile | integral |\n|---|---|---|---|---|---|\n"
    for (brdf, sun, limb), values in plates.items():
        out += (f"| {brdf} | {sun.split()[2]} AU | {limb.split()[2]} | {values['peak']:.1e} | {values['profile']:.1e} "
                f"| {values['integral']:.1e} |\n")
    out += PRECISION + "| BRDF | slope | to 80° | to 85° | to 89.9° |\n|---|---|---|---|---|\n"
    for (brdf, slope), errors in precision.items():
        out += f"| {brdf} | {slope.split()[1]} | " + " | ".join(f"{error:.0e}" for error in errors) + " |\n"
    return out


def rows(case):
    with open(ROOT / f"bench/results/{case}.csv", encoding="utf-8") as file:
        header = [line for line in file if not line.startswith("#")]
    return list(csv.DictReader(header))


def spheres():
    """{way: [(radius, flux error, ms)]} of the Lambert sphere without PSF."""
    ways = {}
    for row in rows("imposters"):
        known = re.match(r"Lambert sphere r=([\d.]+)px ([^,]*(?:, no imposters|, cropped)?)$", row["setting"])
        if known and row["error_unit"] == "relative flux, rms":
            ways.setdefault(known[2], []).append((float(known[1]), float(row["error"]), float(row["speed"])))
    return ways


def far_curves():
    """{name of a file of docs/images: SVG}"""
    ways = spheres()
    out = {"far-flux.svg": curves.chart(
        "Flux of a Lambert sphere, phase 60°", "radius, pixels", "relative error of the flux, rms",
        [(way, [(radius, error) for radius, error, _ in points]) for way, points in ways.items() if way != "imposter, cropped"],
        (0.01, 100), (1e-5, 10), [("asked: 5e-4", 5e-4)])}
    out["far-speed.svg"] = curves.chart(
        "Error and time of the sphere at 1 pixel", "milliseconds an image", "relative error of the flux, rms",
        [(way, [(ms, error) for radius, error, ms in points if radius == 1]) for way, points in ways.items() if way != "imposter, cropped"],
        (1, 1e3), (1e-4, 1), [("asked: 5e-4", 5e-4)])
    ranges = {"imposter": [], "samples, auto": []}
    for row in rows("imposters_craft"):
        known = re.match(r"servicer at ([\d.e+]+) m, [\d.e+-]+ px(, samples)?$", row["setting"])
        if known:
            ranges["samples, auto" if known[2] else "imposter"].append((float(known[1]), float(row["error"])))
    out["far-range.svg"] = curves.chart(
        "Flux of the servicer on an approach", "range, metres", "relative error of the flux",
        [(name, points) for name, points in ranges.items() if points], (1, 1e6), (1e-5, 1e-1), [("asked: 1e-3", 1e-3)])
    return out


def proofs():
    """Links to the pages that hold the measurements of one feature each."""
    pages = sorted((ROOT / "docs/accuracy").glob("*.md"))
    titles = [page.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ") for page in pages]
    return "\n## Measurements by feature\n\n" + "".join(
        f"- [{title}](accuracy/{page.name})\n" for title, page in zip(titles, pages))


def far():
    ways = spheres()
    radii = sorted({radius for points in ways.values() for radius, _, _ in points})
    shown = [radius for radius in radii if radius <= 16]
    out = FAR + "| | " + " | ".join(f"{radius:g} px" for radius in shown) + " |\n|---|" + "---|" * len(shown) + "\n"
    for way, points in ways.items():
        cells = {radius: f"{error:.1e}, {ms:.0f} ms" for radius, error, ms in points}
        out += f"| {way} | " + " | ".join(cells.get(radius, "") for radius in shown) + " |\n"
    steps = [row for row in rows("imposters_craft") if "largest step" in row["setting"]]
    return out + CRAFT + "".join(f"Largest step from one range to the next: {float(row['error']):.1e}.\n\n" for row in steps)


def bars():
    table = {}
    for row in rows("error_bars"):
        scene, samples = row["setting"].removesuffix(" samples").rsplit(": ", 1)
        cell = table.setdefault(scene, {}).setdefault(samples, {})
        cell["share" if row["error_unit"].startswith("share") else "ratio"] = float(row["error"])
    counts = list(next(iter(table.values())))
    out = BARS + "| scene |" + "".join(f" {n} samples | ratio |" for n in counts) + "\n|---|" + "---|---|" * len(counts) + "\n"
    for scene, cells in table.items():
        out += f"| {scene} |" + "".join(
            f" {100 * (1 - cells[n]['share']):.2f} % | {cells[n]['ratio']:.2f} |" for n in counts) + "\n"
    return out


def wide():
    table = {}
    for row in rows("wide"):
        table.setdefault(row["setting"], {"ms": float(row["speed"])})[row["error_unit"]] = (
            float(row["error"]), float(row["reference_error"]))
    out = WIDE
    for setting, values in table.items():
        flux, rmse, ratio = values["flux"], values["rmse"], values["time, ratio"]
        out += f"| {setting} | {flux[0]:.1e} | {rmse[0]:.1e} | {rmse[1]:.0e} | {values['ms']:.0f} | {ratio[0]:.2f} |\n"
    return out + "\n"


def sides(table):
    out, errors = SIDES, []
    for setting, values in table.items():
        if not setting.startswith("servicer from "):
            continue
        place, phase = setting.removeprefix("servicer from ").split(", phase ")
        flux, rmse, flip = values["flux"], values["rmse"], values["flip"]
        out += (f"| {place} | {phase.split()[0]}° | {flux[0]:.1e} | {flux[1]:.0e} | {rmse[0]:.1e} | {rmse[1]:.0e} "
                f"| {flip[0]:.4f} | {values['ms']:.0f} |\n")
        errors.append(flux[0])
    if not errors:
        return ""
    errors.sort()
    half = len(errors) // 2
    return out + f"\nFlux: median {(errors[half] + errors[~half]) / 2:.1e}, {errors[0]:.1e} to {errors[-1]:.1e}.\n\n"


def page():
    table = {}
    for row in rows("accuracy"):
        table.setdefault(row["setting"], {"ms": float(row["speed"])})[row["error_unit"]] = (
            float(row["error"]), float(row["reference_error"]))
    out = INTRO
    for subject in ("sphere", "servicer"):
        out += f"## {subject.capitalize()}\n\n| BRDF | flux | ± | RMSE | ± | FLIP | ms a frame |\n|---|---|---|---|---|---|---|\n"
        for setting, values in table.items():
            if not setting.startswith(subject + ", "):
                continue
            flux, rmse, flip = values["flux"], values["rmse"], values["flip"]
            out += (f"| {setting[len(subject) + 2:]} | {flux[0]:.1e} | {flux[1]:.0e} | {rmse[0]:.1e} | {rmse[1]:.0e} "
                    f"| {flip[0]:.4f} | {values['ms']:.0f} |\n")
        out += "\n"
    return (out + sides(table) + far() + glint() + "\n" + moments() + wide()).rstrip("\n") + "\n" + bars() + NOTES + proofs()


def main():
    files = {ROOT / "docs/accuracy.md": page()}
    files |= {ROOT / "docs/images" / name: text for name, text in far_curves().items()}
    for target, text in files.items():
        if sys.argv[1:] != ["--check"]:
            target.write_text(text, encoding="utf-8")
        elif not target.exists() or target.read_text(encoding="utf-8") != text:
            sys.exit(f"{target.relative_to(ROOT)} is not what bench/accuracy_table.py makes of bench/results; run it")


if __name__ == "__main__":
    main()
