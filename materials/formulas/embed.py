#!/usr/bin/env python3
"""Writes a C++ source that holds the formulas as strings: embed.py OUTPUT FILE…

The strings are the GLSL reading: every local value and every returned expression is made `precise`, which
GLSL asks for one by one and C++ has by default. A text outside the subset that C++ and GLSL share is refused.
"""

import pathlib
import re
import sys

FORBIDDEN = {
    r"\b(out|inout|uniform|sampler\w*|texture\w*|precise|const|static|auto|template|double|float|vec\d|dvec\d)\b":
        "only Real, Vec3 and FORMULA name types, and arguments are values",
    r"\b(a?sin|a?cos|a?tan|exp2?|log2?|pow|inversesqrt|normalize|length|dot|cross|mix|clamp|fma)\(":
        "built-ins other than sqrt, min, max and abs differ between processors",
    r"\.[xyzrgb]{2,}\b": "swizzles are not C++",
    r"^#": "the preprocessor belongs to whoever assembles the texts",
    r"\b\d+\.\d*[fF]\b": "literals are Real(…)",
}
CONSTANT = re.compile(r"(Vec3\()?Real\([-\d.e]+\)\)?")


def code_of(text):
    return re.sub(r"//[^\n]*", "", text)


def check(file, text):
    for number, line in enumerate(code_of(text).split("\n"), 1):
        for pattern, reason in FORBIDDEN.items():
            if re.search(pattern, line):
                sys.exit(f"{file}:{number}: {reason}")


def precise(text):
    result_type = None

    def exact_return(match):
        if CONSTANT.fullmatch(match[2]):
            return match[0]
        body = f"precise {result_type} exact_result = {match[2]}; return exact_result;"
        # at the end of a function no braces, so that every compiler sees that it returns
        return f"{match[1]}{body}" if match[1] in ("  ", " ") else f"{match[1]}{{ {body} }}"

    pieces = re.split(r"^(?=FORMULA )", text, flags=re.M)
    for i, piece in enumerate(pieces):
        head = re.match(r"FORMULA (Real|Vec3) ", piece)
        if not head:
            continue
        result_type = head[1]
        piece = re.sub(r"^(\s+)(Real|Vec3) (\w+) =", r"\1precise \2 \3 =", piece, flags=re.M)
        piece = re.sub(r"(?<=\{)( )return ([^;]+);", exact_return, piece)
        piece = re.sub(r"^(\s+(?:if \(.*\) )?)return ([^;]+);", exact_return, piece, flags=re.M)
        pieces[i] = piece
    return "".join(pieces)


def main():
    output, files = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
    lines = ['#include "materials/internal/formula_texts.h"', "", "namespace panwright::materials {", ""]
    for file in files:
        text = file.read_text(encoding="utf-8")
        check(file, text)
        lines += [f'const char* const {file.stem}_text = R"formula({precise(text)})formula";', ""]
    lines += ["}  // namespace panwright::materials", ""]
    output.write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
