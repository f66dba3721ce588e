#!/usr/bin/env python3
"""Writes materials/internal/optical_tables.h from public tables: optical_tables.py DATA | clang-format > optical_tables.h

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


def solar_rows(data):
    rows = []
    for line in (data / "solar/astm_e490_00a.dat").read_text(encoding="utf-8").split("\n"):
        if re.fullmatch(r"[\d.]+\s+[-\d.eE+]+\s*", line):
            rows.append([float(x) for x in line.split()])
    return sorted(rows)


def solar_weights(data, grid):
    """Integrals of the irradiance times the hat of each grid point, as shares of all."""
    rows = solar_rows(data)
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


# linear sRGB of X, Y, Z under D65 (IEC 61966-2-1), and the cone space of K. M. Lam's "Bradford" adaptation
SRGB_FROM_XYZ = [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
BRADFORD = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
D65 = (0.95047, 1.0, 1.08883)


def observer(x):
    """CIE 1931 colour matching functions at x um, as sums of lobes: C. Wyman, P.-P. Sloan, P. Shirley, "Simple analytic
    approximations to the CIE XYZ color matching functions", J. Computer Graphics Techniques 2(2), 2013, table 1."""
    def lobe(centre, below, above):
        t = (1000 * x - centre) * (below if 1000 * x < centre else above)
        return math.exp(-t * t / 2)
    return (0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323) - 0.065 * lobe(501.1, 0.0490, 0.0382),
            0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
            1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725))


def times(matrix, vector):
    return [sum(m * v for m, v in zip(row, vector)) for row in matrix]


def inverse(m):
    cofactor = [[m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3]
                 - m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3] for j in range(3)] for i in range(3)]
    det = sum(m[0][j] * cofactor[0][j] for j in range(3))
    return [[cofactor[j][i] / det for j in range(3)] for i in range(3)]


def color_weights(data, grid):
    """Linear sRGB of a transmittance in sunlight, the Sun being white: weights of each grid point's hat."""
    rows = solar_rows(data)
    sums = [[0.0] * 3 for _ in grid]
    steps = 22000
    for i in range(steps):
        x = FIRST + (i + 0.5) * (LAST - FIRST) / steps
        if not 0.36 <= x <= 0.83:
            continue
        k = min(bisect.bisect_right(grid, x), len(grid) - 1)
        t = (x - grid[k - 1]) / (grid[k] - grid[k - 1])
        for j, c in enumerate(observer(x)):
            c *= interpolated(rows, x)
            sums[k - 1][j] += (1 - t) * c
            sums[k][j] += t * c
    white = [sum(each[j] for each in sums) for j in range(3)]
    sums = [[v / white[1] for v in each] for each in sums]
    cones = times(BRADFORD, [v / white[1] for v in white])
    scale = [a / b for a, b in zip(times(BRADFORD, D65), cones)]
    weights = []
    for each in sums:
        adapted = times(inverse(BRADFORD), [s * v for s, v in zip(scale, times(BRADFORD, each))])
        weights.append(times(SRGB_FROM_XYZ, adapted))
    # white is white, to the last digit
    totals = [sum(w[j] for w in weights) for j in range(3)]
    return [[w[j] / totals[j] for w in weights] for j in range(3)]


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
           "// Linear sRGB of a transmittance in sunlight, of which the light itself is 1 1 1: weight of each",
           "// wavelength's hat. CIE 1931 observer, adapted from ASTM E490 to D65.",
           "// clang-format off",
           f"inline constexpr std::array<std::array<double, {len(grid)}>, 3> kSunlitColor{{{{",
           ",\n".join("{\n" + numbers(row, 6) + "}" for row in color_weights(data, grid)) + "}};",
           "// clang-format on", "",
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
