#!/usr/bin/env python3
"""Checks that clang-format leaves every source as it is. 77, skipped: there is no clang-format 14."""

import pathlib
import re
import shutil
import subprocess
import sys

import sources

VERSION = 14  # others format a few constructs in other ways


def main(root):
    program = shutil.which(f"clang-format-{VERSION}") or shutil.which("clang-format")
    version = subprocess.run([program, "--version"], capture_output=True, text=True).stdout if program else ""
    if not re.search(rf"version {VERSION}\.", version):
        print(f"format: skipped, clang-format {VERSION} is not installed (scripts/setup --test)")
        return 77
    done = subprocess.run([program, "--dry-run", "-Werror", *sources.listed(root)], cwd=root, capture_output=True, text=True)
    bad = sorted(set(re.findall(r"^([^\s:]+):\d+:\d+: error", done.stderr, re.M)))
    if done.returncode == 0:
        print("format: ok")
        return 0
    print("\n".join(bad) or done.stderr)
    print("format: run clang-format -i on these")
    return 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
