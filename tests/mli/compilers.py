#!/usr/bin/env python3
"""Sheets have the same bits whatever compiler, optimisation and number of threads: what decides them,
mli/, base/math.cpp and the normals of meshes, is compiled by clang++ without optimisation and by g++ with all of it.

    compilers.py SHEETS BASE FOLDER    mli_sheets and libpanwright_base.a of the build, a folder to work in

Exit code 77: clang++ is not installed (scripts/setup installs it).
"""
import concurrent.futures
import glob
import os
import shutil
import subprocess
import sys

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
FLAGS = ["-std=c++20", "-ffp-contract=off", "-DGLM_FORCE_CTOR_INIT", f"-I{ROOT}", "-w"]
LIBRARIES = ["-lfmt", "-lxxhash", "-lsleef", "-lpng", "-ltbb", "-ltomlplusplus", "-lyaml-cpp", "-lpthread"]


def run(command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return done.stdout


def built(compiler, level, base, folder):
    """The program as one compiler makes it."""
    here = os.path.join(folder, f"{compiler}{level}")
    os.makedirs(here, exist_ok=True)
    sources = sorted(glob.glob(f"{ROOT}/mli/*.cpp") + glob.glob(f"{ROOT}/mli/internal/*.cpp"))
    sources += [f"{ROOT}/{name}" for name in ("base/math.cpp", "geometry/symmetric.cpp", "geometry/mesh/face_groups.cpp", "geometry/ray/box_tree.cpp", "geometry/mesh/normals.cpp", "geometry/internal/compressed_rows.cpp", "geometry/internal/triangle.cpp", "geometry/internal/weld.cpp",
                                             "tests/mli/sheets.cpp")]
    cache = ["ccache"] if shutil.which("ccache") else []
    objects = []
    for source in sources:
        objects.append(os.path.join(here, os.path.relpath(source, ROOT).replace("/", "_") + ".o"))
        run([*cache, compiler, *FLAGS, level, "-c", source, "-o", objects[-1]])
    program = os.path.join(here, "mli_sheets")
    # base is one object with math.cpp in it: the one compiled here stands first
    run([compiler, "-Wl,--allow-multiple-definition", *objects, base, *LIBRARIES, "-o", program])
    return program


def main():
    if not shutil.which("clang++"):
        print("clang++ is not installed: nothing was compared")
        return 77
    sheets, base, folder = sys.argv[1:4]
    ways = [("clang++", "-O0"), ("g++", "-O3")]  # the build is clang++'s with most of it
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        programs = list(pool.map(lambda way: built(*way, base, folder), ways))
        runs = [(name, program, threads)
                for name, program in [("the build", sheets), *zip(map(" ".join, ways), programs)]
                for threads in ("1", "8")]
        outputs = list(pool.map(lambda each: run([each[1], each[2]]), runs))
    expected = outputs[0]
    wrong = 0
    for (name, _, threads), output in zip(runs, outputs):
        for want, got in zip(expected.splitlines(), output.splitlines()):
            if want != got:
                print(f"{name}, {threads} threads: {got}; the build with one thread: {want}")
                wrong += 1
    print(f"{len(expected.splitlines())} sheets by {len(programs)} compilers and the build, "
          f"{wrong} differ")
    return 1 if wrong or not expected else 0


if __name__ == "__main__":
    sys.exit(main())
