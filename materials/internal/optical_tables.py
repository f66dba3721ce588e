#!/usr/bin/env python3
"""Writes materials/internal/optical_tables.h from public tables: optical_tables.py DATA > optical_tables.h

DATA holds refractiveindex/ (files of refractiveindex.info, CC0) and solar/astm_e490_00a.dat. One grid of wavelengths serves all
materials: points are added where linear interpolation is worst, until reflectances (and transmittances of films) are within
TOLERANCE at every point of the sources.
"""

import bisect
import math
import pathlib
import re
import sys

FIRST, LAST = 0.3, 2.5  # um
TOLERANCE = 0.01
MOST = 45

# name, what it is, file, file that goes on where the first ends, source
MATERIALS = [
    ("Ag", "silver, evaporated", "Ag/Rakic-BB", None, "A. D. Rakic and others, Appl. Opt. 37, 5271 (1998)"),
    ("Al", "aluminium, evaporated", "Al/Rakic", None, "A. D. Rakic, Appl. Opt. 34, 4755 (1995)"),
    ("Au", "gold", "Au/Johnson", "free electrons", "P. B. Johnson, R. W. Christy, Phys. Rev. B 6, 4370 (1972)"),
    ("Cu", "copper", "Cu/Johnson", "free electrons", "P. B. Johnson, R. W. Christy, Phys. Rev. B 6, 4370 (1972)"),
    ("GaAs", "gallium arsenide", "GaAs/Adachi", None, "S. Adachi, J. Appl. Phys. 66, 6030 (1989)"),
    ("Ge", "germanium", "Ge/Nunley", "constant", "T. N. Nunley and others, J. Vac. Sci. Technol. B 34, 061205 (2016)"),
    ("Kapton", "polyimide film", "commercial_polymers/Kapton/French", "commercial_polymers/Kapton/Zhang",
     "R. H. French and others, 34th IEEE PVSC, 394 (2009); k below 0.43 um: E. T. Arakawa and others, J. Appl. Phys. 52, 3579 "
     "(1981); n from 1.6 um on: Z. M. Zhang and others, Int. J. Thermophys. 19, 905 (1998)"),
    ("MgF2", "magnesium fluoride, ordinary ray", "MgF2/Li-o", None, "H. H. Li, J. Phys. Chem. Ref. Data 9, 161 (1980)"),
    ("Si", "silicon", "Si/Green-2008", "Si/Salzberg",
     "M. A. Green, Sol. Energy Mater. Sol. Cells 92, 1305 (2008); from 1.45 um on C. D. Salzberg, J. J. Villa, J. Opt. Soc. Am. "
     "47, 244 (1957)"),
    ("SiO2", "fused silica", "SiO2/Malitson", None, "I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965)"),
    ("Ti", "titanium", "Ti/Rakic-BB", None, "A. D. Rakic and others, Appl. Opt. 37, 5271 (1998)"),
    ("graphite", "graphite, ordinary ray", "C/Djurisic-o", None, "A. B. Djurisic, E. H. Li, J. Appl. Phys. 85, 7404 (1999)"),
    ("steel", "stainless steel, austenitic", "alloys/stainless_steel/Karlsson-austenitic", None,
     "B. Karlsson, C. G. Ribbing, J. Appl. Phys. 53, 6340 (1982)"),
]
CLEAR = {"Kapton": 25.0, "MgF2": 1.0, "SiO2": 1.0}  # films of so many um


def read(path):
    """Tables by kind (nk, n, k) as lists of rows, and the coefficients of formula 1."""
    tables, coefficients, rows = {}, None, None
    for line in path.read_text(encoding="utf-8").split("\n"):
        if match := re.match(r"\s*- type: tabulated (\w+)", line):
            rows = tables.setdefault(match[1], [])
        elif match := re.match(r"\s*coefficients: (.*)", line):
            coefficients = [float(x) for x in match[1].split()]
        elif rows is not None and re.fullmatch(r"\s*[-\d.eE+]+(\s+[-\d.eE+]+)+\s*", line):
            rows.append([float(x) for x in line.split()])
    return tables, coefficients


def interpolated(rows, x, column=1):
    i = min(max(bisect.bisect_right([row[0] for row in rows], x), 1), len(rows) - 1)
    a, b = rows[i - 1], rows[i]
    t = min(max((x - a[0]) / (b[0] - a[0]), 0), 1)
    return a[column] + t * (b[column] - a[column])


def sellmeier(c, x):
    terms = sum(c[i] * x * x / (x * x - c[i + 1] ** 2) for i in range(1, len(c) - 1, 2))
    return math.sqrt(1 + c[0] + terms)


def source(data, name, file, further):
    """n + ik as a function of the wavelength."""
    tables, coefficients = read(data / "refractiveindex" / (file + ".yml"))
    if coefficients:
        return lambda x: complex(sellmeier(coefficients, x), 0)
    if name == "Kapton":
        infrared = read(data / "refractiveindex" / (further + ".yml"))[0]["nk"]
        violet = read(data / "refractiveindex/commercial_polymers/Kapton/Arakawa.yml")[0]["k"]
        n_rows = tables["n"] + [row[:2] for row in infrared]
        # logarithms, for it falls by decades
        k_rows = [[x, math.log(max(k, 1e-9))] for x, k in violet + tables["k"] if x < 0.44 or x >= 0.48]
        return lambda x: complex(interpolated(n_rows, x), math.exp(interpolated(k_rows, x)))
    rows = tables["nk"]
    end = rows[-1]
    beyond = read(data / "refractiveindex" / (further + ".yml"))[1] if further and "/" in further else None

    def value(x):
        if x > end[0]:
            if beyond:
                return complex(sellmeier(beyond, x), 0)
            if further == "free electrons":
                return complex(end[1] * (x / end[0]) ** 2, end[2] * x / end[0])
        return complex(interpolated(rows, x), interpolated(rows, x, 2))

    return value


def measures(index, x, name):
    """What linear interpolation of n and k must keep."""
    result = [abs((index - outer) / (index + outer)) ** 2 for outer in ((1, 1.5) if name not in CLEAR else (1,))]
    if name in CLEAR:
        result.append(math.exp(-8 * math.pi * index.imag * CLEAR[name] / x))
    return result


def chosen_grid(sources):
    fine = [FIRST + i * 0.005 for i in range(round((LAST - FIRST) / 0.005) + 1)]
    grid = [FIRST, 0.45, 0.55, 0.65, LAST]
    while len(grid) < MOST:
        worst, at = 0, None
        for x in fine:
            i = min(bisect.bisect_right(grid, x), len(grid) - 1)
            a, b = grid[i - 1], grid[i]
            t = (x - a) / (b - a)
            for name, value in sources.items():
                guess = (1 - t) * value(a) + t * value(b)
                error = max(abs(g - w) for g, w in zip(measures(guess, x, name), measures(value(x), x, name)))
                if error > worst:
                    worst, at = error, x
        print(f"{len(grid)} points: {worst:.4f} at {at:.3f} um", file=sys.stderr)
        if worst <= TOLERANCE:
            break
        grid = sorted(grid + [round(at, 3)])
    return grid


def solar_weights(data, grid):
    """Integrals of the irradiance times the hat of each grid point, as shares of all."""
    rows = []
    for line in (data / "solar/astm_e490_00a.dat").read_text(encoding="utf-8").split("\n"):
        if re.fullmatch(r"[\d.]+\s+[-\d.eE+]+\s*", line):
            rows.append([float(x) for x in line.split()])
    rows.sort()
    weights = [0.0] * len(grid)
    steps = 22000
    for i in range(steps):
        x = FIRST + (i + 0.5) * (LAST - FIRST) / steps
        k = min(bisect.bisect_right(grid, x), len(grid) - 1)
        t = (x - grid[k - 1]) / (grid[k] - grid[k - 1])
        e = interpolated(rows, x)
        weights[k - 1] += (1 - t) * e
        weights[k] += t * e
    total = sum(weights)
    return [w / total for w in weights]


def numbers(values, digits):
    texts = [f"{v:.{digits}g}" for v in values]
    lines, line = [], "   "
    for text in texts:
        if len(line) + len(text) + 2 > 98:
            lines.append(line)
            line = "   "
        line += " " + text + ","
    return "\n".join(lines + [line])


def main():
    data = pathlib.Path(sys.argv[1])
    sources = {name: source(data, name, file, further) for name, _, file, further, _ in MATERIALS}
    grid = chosen_grid(sources)
    out = ["// n and k by optical_tables.py from files of refractiveindex.info (CC0), solar irradiance of ASTM", "// E490-00a. Private to materials.",
           "#pragma once", "", "#include <array>", "#include <string_view>", "", "namespace panwright::materials {", "",
           "struct OpticalTable {", "  std::string_view name;", "  std::string_view what;",
           f"  std::array<double, {len(grid)}> n;", f"  std::array<double, {len(grid)}> k;", "};", "",
           "// um; interpolation keeps reflectances, and what passes 25 um of Kapton, within 0.014",
           f"inline constexpr std::array<double, {len(grid)}> kWavelengths{{", numbers(grid, 4) + "};", "",
           "// of the solar irradiance from 0.3 to 2.5 um (95.6 % of all): share of each wavelength's hat",
           f"inline constexpr std::array<double, {len(grid)}> kSolarShares{{", numbers(solar_weights(data, grid), 6) + "};", "",
           f"inline constexpr std::array<OpticalTable, {len(MATERIALS)}> kOpticalTables{{{{"]
    for name, what, _, _, reference in MATERIALS:
        values = [sources[name](x) for x in grid]
        line = "    //"
        for word in reference.split():
            if len(line) + len(word) + 1 > 98:
                out.append(line)
                line = "    //"
            line += " " + word
        out += [line, f'    {{"{name}", "{what}",', "    {" + numbers([v.real for v in values], 5).strip() + "},",
                "    {" + numbers([v.imag for v in values], 5).strip() + "}},"]
    out += ["}};", "", "}  // namespace panwright::materials"]
    print("\n".join(out))


if __name__ == "__main__":
    main()
