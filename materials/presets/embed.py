#!/usr/bin/env python3
"""Writes a C++ source that holds the library's materials as text: embed.py OUTPUT FILE…"""

import pathlib
import sys


def main():
    files = sorted((pathlib.Path(name) for name in sys.argv[2:]), key=lambda file: file.stem)
    lines = ['#include "pxn/reader/presets.h"', "", "namespace panwright::pxn {", "",
             "const PresetText kPresetTexts[] = {"]
    for file in files:
        lines.append(f'    {{"{file.stem}", R"preset({file.read_text(encoding="utf-8")})preset"}},')
    lines += ["};", f"const std::size_t kPresetCount = {len(files)};", "", "}  // namespace panwright::pxn", ""]
    pathlib.Path(sys.argv[1]).write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
