#!/usr/bin/env python3
"""Writes a C++ source that holds files as strings: embed.py OUTPUT HEADER NAME=FILE…

HEADER is that of the folder, as tools/templates.h, and declares `std::string NAME();`. Long strings are in pieces: compilers
promise 64 KiB of one.
"""

import pathlib
import sys

PIECE = 15000
PLAIN = {code: chr(code) for code in range(32, 127) if chr(code) not in '"\\?'}


def literal(piece):
    return "".join(PLAIN.get(byte) or f"\\{byte:03o}" for byte in piece)


output, header = pathlib.Path(sys.argv[1]), sys.argv[2]
namespace = "panwright::" + header.split("/")[0]
lines = [f'#include "{header}"', "", f"namespace {namespace} {{", ""]
for pair in sys.argv[3:]:
    name, file = pair.split("=", 1)
    data = pathlib.Path(file).read_bytes()
    lines.append(f"std::string {name}() {{\n  std::string out;\n  out.reserve({len(data)});")
    for start in range(0, len(data), PIECE):
        piece = data[start:start + PIECE]
        lines.append(f'  out.append("{literal(piece)}", {len(piece)});')
    lines += ["  return out;", "}", ""]
lines += [f"}}  // namespace {namespace}", ""]
output.write_text("\n".join(lines), encoding="ascii")
