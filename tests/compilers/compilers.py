#!/usr/bin/env python3
"""Two compilers make the same pan files, to the byte: the program of this build (gcc, little
optimised, with ThreadSanitizer) with one thread and the one of another (clang, optimised) with eight.

    compilers.py PROGRAM OTHER FOLDER [CORPUS]    two panwright programs, a folder to work in, the
                                                  folder of public test data

Exit code 77: there is no OTHER (`cmake --build --preset release` makes it).
"""
import concurrent.futures
import filecmp
import os
import shlex
import shutil
import subprocess
import sys

from models import models


def written(program, path, threads, output):
    """Whether the program made a pan file of the model; what it said otherwise."""
    command = "compile" if path.endswith(".pxn") else "import"
    words = [program, command, path, "-o", output, "-j", str(threads), "--no-cache", "--quiet"]
    done = subprocess.run(words, capture_output=True, text=True)
    return "" if os.path.exists(output) else f"{shlex.join(words)}\n{done.stderr}"


def compared(path, programs, folder):
    """What is wrong with a model's two files."""
    said = []
    outputs = []
    for (program, threads), name in zip(programs, ("this", "other")):
        outputs.append(os.path.join(folder, name, os.path.basename(path) + ".pan"))
        said.append(written(program, path, threads, outputs[-1]))
    if any(said):
        return "".join(said)
    same = filecmp.cmp(*outputs, shallow=False)
    for output in outputs:
        os.remove(output)
    return "" if same else f"{path}: the two programs' files differ\n"


def main():
    program, other, folder = sys.argv[1:4]
    if not os.path.exists(other):
        print(f"{other} is not there: nothing was compared")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("this", "other"):
        os.makedirs(os.path.join(folder, name))
    files = list(models(sys.argv[4] if len(sys.argv) > 4 else ""))
    programs = ((program, 1), (other, 8))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        said = [text for text in pool.map(lambda path: compared(path, programs, folder), files)
                if text]
    print("".join(said), end="")
    print(f"{len(files)} models, {len(said)} not the same whatever the compiler and the threads")
    return 1 if said or not files else 0


if __name__ == "__main__":
    sys.exit(main())
