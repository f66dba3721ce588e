#!/usr/bin/env python3
"""Reads every source of the libraries and the program with clang too, syntax only: what gcc takes
and clang refuses breaks the fuzz targets.

    clang.py BUILD    the build folder, with its compile_commands.json

Exit code 77: clang++ is not installed (scripts/setup --test installs it).
"""
import concurrent.futures
import json
import os
import shlex
import shutil
import subprocess
import sys
import time

# of gcc alone
REFUSED = ("-fno-fat-lto-objects",)


def sources(build):
    """(file, folder, arguments) of each source."""
    root = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
    seen = set()
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        commands = json.load(file)
    for command in commands:
        path = os.path.realpath(os.path.join(command["directory"], command["file"]))
        if not path.startswith(root + os.sep) or path.startswith(os.path.realpath(build) + os.sep):
            continue
        folder = os.path.relpath(path, root).split(os.sep)[0]
        if folder in ("tests", "bench") or path in seen:
            continue
        seen.add(path)
        words = iter(shlex.split(command["command"]))
        arguments = []
        for word in words:
            if word == "-o":
                next(words)
            elif arguments or word.startswith("-"):
                if word != "-c" and word not in REFUSED:
                    arguments.append(word)
        yield path, command["directory"], arguments


def refused(source):
    """What clang says of a source that it refuses; "" of others."""
    path, folder, arguments = source
    done = subprocess.run(
        ["clang++", "-fsyntax-only", "-w", *arguments], cwd=folder, capture_output=True, text=True)
    return f"{path}\n{done.stderr}" if done.returncode else ""


def main():
    if not shutil.which("clang++"):
        print("clang++ is not installed: nothing was read")
        return 77
    start = time.monotonic()
    todo = list(sources(sys.argv[1]))
    if not todo:
        print("no sources found")
        return 1
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        said = [text for text in pool.map(refused, todo) if text]
    print("\n".join(said))
    print(f"{len(todo)} sources, {len(said)} refused, {(time.monotonic() - start) / 60:.1f} min")
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
