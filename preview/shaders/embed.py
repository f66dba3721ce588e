#!/usr/bin/env python3
"""Writes a C++ source that holds shader files as strings: embed.py OUTPUT FILE…"""

import pathlib
import sys

output, files = pathlib.Path(sys.argv[1]), [pathlib.Path(name) for name in sys.argv[2:]]
lines = ['#include "preview/gl/shader_text.h"', "", "namespace panwright::preview {", ""]
for file in files:
    name = file.name.replace(".", "_")
    text = file.read_text(encoding="utf-8")
    assert ')shader"' not in text, file
    lines += [f'extern const char* const {name} = R"shader({text})shader";', ""]
lines += ["}  // namespace panwright::preview", ""]
output.write_text("\n".join(lines), encoding="utf-8")
