#!/usr/bin/env python3
"""Writes a C++ source that holds files as strings: embed.py OUTPUT NAME=FILE…

Long ones in pieces: compilers promise 64 KiB of a string.
"""

import pathlib
import sys

PIECE = 15000
PLAIN = {code: chr(code) for code in range(32, 127) if chr(code) not in '"\\?'}


def literal(piece):
    return "".join(PLAIN.get(byte) or f"\\{byte:03o}" for byte in piece)


output = pathlib.Path(sys.argv[1])
lines = ['#include "tools/templates.h"', "", "namespace panwright::tools {", ""]
for pair in sys.argv[2:]:
    name, file = pair.split("=", 1)
    data = pathlib.Path(file).read_bytes()
    lines.append(f"std::string {name}() {{\n  std::string out;")
    for start in range(0, len(data), PIECE):
        piece = data[start:start + PIECE]
        lines.append(f'  out.append("{literal(piece)}", {len(piece)});')
    lines += ["  return out;", "}", ""]
lines += ["}  // namespace panwright::tools", ""]
output.write_text("\n".join(lines), encoding="ascii")
