#!/usr/bin/env python3
"""Writes a C++ source that holds files as strings: embed.py OUTPUT NAME=FILE…

Long ones in pieces: compilers promise 64 KiB of a string.
"""

import pathlib
import sys

PIECE = 15000

output = pathlib.Path(sys.argv[1])
lines = ['#include "tools/templates.h"', "", "namespace panwright::tools {", ""]
for pair in sys.argv[2:]:
    name, file = pair.split("=", 1)
    text = pathlib.Path(file).read_text(encoding="utf-8")
    assert ')file"' not in text, file
    lines.append(f"std::string {name}() {{\n  std::string out;")
    lines += [f'  out += R"file({text[i:i + PIECE]})file";' for i in range(0, len(text), PIECE)]
    lines += ["  return out;", "}", ""]
lines += ["}  // namespace panwright::tools", ""]
output.write_text("\n".join(lines), encoding="utf-8")
