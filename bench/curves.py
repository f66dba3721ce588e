"""Curves of speed, error and range as SVG, for docs/accuracy.md. Log axes; no dependency but Python."""

import math

# Okabe and Ito's colours, which colour-blind people tell apart, and marks that tell them apart in print
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#888888")
MARKS = ("circle", "square", "diamond", "up", "down", "cross", "plus", "ring")
WIDTH, HEIGHT = 720, 420
LEFT, RIGHT, TOP, BOTTOM = 78, 190, 40, 56


def mark(kind, x, y, colour):
    r = 4
    if kind == "circle":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r - 0.5}" fill="{colour}"/>'
    if kind == "ring":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r}" fill="none" stroke="{colour}" stroke-width="2"/>'
    if kind in ("cross", "plus"):
        d = r * (0.8 if kind == "cross" else 1.1)
        ends = ((-d, -d, d, d), (-d, d, d, -d)) if kind == "cross" else ((-d, 0, d, 0), (0, -d, 0, d))
        lines = "".join(f"M{x + a:.1f} {y + b:.1f}L{x + c:.1f} {y + e:.1f}" for a, b, c, e in ends)
        return f'<path d="{lines}" stroke="{colour}" stroke-width="2" fill="none"/>'
    corners = {"square": ((-1, -1), (1, -1), (1, 1), (-1, 1)), "diamond": ((0, -1.3), (1.3, 0), (0, 1.3), (-1.3, 0)),
               "up": ((0, -1.2), (1.1, 0.9), (-1.1, 0.9)), "down": ((0, 1.2), (1.1, -0.9), (-1.1, -0.9))}[kind]
    points = " ".join(f"{x + (r - 0.5) * a:.1f},{y + (r - 0.5) * b:.1f}" for a, b in corners)
    return f'<polygon points="{points}" fill="{colour}"/>'


def ticks(low, high):
    """Powers of ten from low to high, and what lies between them."""
    first, last = round(math.log10(low)), round(math.log10(high))
    major = [10.0 ** e for e in range(first, last + 1)]
    minor = [d * 10.0 ** e for e in range(first, last) for d in range(2, 10)]
    return major, minor


def number(value):
    exponent = round(math.log10(value))
    if -2 <= exponent <= 3:
        return f"{value:g}"
    return f'10<tspan dy="-5" font-size="9">{str(exponent).replace("-", "−")}</tspan>'


def chart(title, x_label, y_label, series, x_range, y_range, bounds=()):
    """An SVG text. series: (name, points) each; points that are 0 or not finite are left out, those beyond
    y_range stand at its border. bounds: (name, value of y) each, as dashed lines."""
    def x_of(value):
        return LEFT + (WIDTH - LEFT - RIGHT) * math.log(value / x_range[0]) / math.log(x_range[1] / x_range[0])

    def y_of(value):
        value = min(max(value, y_range[0]), y_range[1])
        return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * math.log(value / y_range[0]) / math.log(y_range[1] / y_range[0])

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" '
           'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="12">',
           f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>',
           f'<text x="{LEFT}" y="22" font-size="14" font-weight="bold">{title}</text>']
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    for major, axis in ((ticks(*x_range), "x"), (ticks(*y_range), "y")):
        for kind, colour in ((1, "#eeeeee"), (0, "#cccccc")):
            for value in major[kind]:
                if axis == "x":
                    at = x_of(value)
                    out.append(f'<path d="M{at:.1f} {TOP}V{bottom}" stroke="{colour}"/>')
                    if kind == 0:
                        out.append(f'<text x="{at:.1f}" y="{bottom + 18}" text-anchor="middle">{number(value)}</text>')
                else:
                    at = y_of(value)
                    out.append(f'<path d="M{LEFT} {at:.1f}H{right}" stroke="{colour}"/>')
                    if kind == 0:
                        out.append(f'<text x="{LEFT - 8}" y="{at + 4:.1f}" text-anchor="end">{number(value)}</text>')
    out.append(f'<text x="{(LEFT + right) / 2}" y="{HEIGHT - 14}" text-anchor="middle">{x_label}</text>')
    out.append(f'<text transform="translate(18 {(TOP + bottom) / 2}) rotate(-90)" text-anchor="middle">{y_label}</text>')
    for name, value in bounds:
        out.append(f'<path d="M{LEFT} {y_of(value):.1f}H{right}" stroke="#555555" stroke-dasharray="6 4"/>')
        out.append(f'<text x="{right + 6}" y="{y_of(value) + 4:.1f}" fill="#555555">{name}</text>')
    for index, (name, points) in enumerate(series):
        colour, kind = COLOURS[index % len(COLOURS)], MARKS[index % len(MARKS)]
        places = [(x_of(x), y_of(y)) for x, y in points if x > 0 and y > 0 and math.isfinite(x) and math.isfinite(y)]
        if len(places) > 1:
            out.append(f'<polyline fill="none" stroke="{colour}" stroke-width="1.6" points="'
                       + " ".join(f"{x:.1f},{y:.1f}" for x, y in places) + '"/>')
        out += [mark(kind, x, y, colour) for x, y in places]
        y = TOP + 12 + 20 * index
        out += [mark(kind, right + 16, y - 4, colour), f'<text x="{right + 28}" y="{y}">{name}</text>']
    return "\n".join(out + ["</svg>"]) + "\n"
