#!/usr/bin/env python3
"""Compiles what makes pan files with clang too: what gcc takes and clang refuses breaks the fuzz
targets. It becomes a program, whose files must be those of the program that gcc built, to the byte,
with one thread and with eight.

    clang.py BUILD [CORPUS]    the build folder, with its compile_commands.json and bin/panwright;
                               the folder of public test data

Exit code 77: clang++ is not installed (scripts/setup --test installs it).
"""
import concurrent.futures
import filecmp
import json
import os
import shlex
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "compilers"))
from models import models

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
# of gcc alone
REFUSED = ("-fno-fat-lto-objects",)
# what makes pan files
LINKED = ("base", "geometry", "materials", "mli", "scene", "pan", "world", "importers", "compiler", "pxn")
# but for the program that holds OpenCASCADE
STEP_READER = tuple(f"importers/step/{name}.cpp" for name in (
    "main", "internal/bodies", "internal/document", "internal/exact", "internal/read",
    "internal/text"))


class Build:
    """clang's half of a build folder."""

    def __init__(self, build):
        self.build = os.path.realpath(build)
        self.folder = os.path.join(self.build, "clang")
        os.makedirs(self.folder, exist_ok=True)
        self.ccache = [shutil.which("ccache")] if shutil.which("ccache") else []
        self.environment = dict(
            os.environ, CCACHE_BASEDIR=ROOT, CCACHE_NOHASHDIR="1",
            CCACHE_SLOPPINESS="pch_defines,time_macros,include_file_mtime,include_file_ctime")
        self.header = os.path.join(self.folder, "common.pch")

    def sources(self):
        """(file, folder, arguments) of each source, but for tests and benchmarks."""
        seen = set()
        with open(os.path.join(self.build, "compile_commands.json"), encoding="utf-8") as file:
            commands = json.load(file)
        for command in commands:
            path = os.path.realpath(os.path.join(command["directory"], command["file"]))
            if not path.startswith(ROOT + os.sep) or path in seen:
                continue
            # what is generated in the build folder is data: only the program needs it
            if self.folder_of(path) in ("tests", "bench") or (
                    path.startswith(self.build + os.sep) and not self.is_linked(path)):
                continue
            seen.add(path)
            words = iter(shlex.split(command["command"]))
            arguments = []
            for word in words:
                if word == "-o":
                    next(words)
                elif arguments or word.startswith("-"):
                    if word != "-c" and word not in REFUSED and not word.endswith(".cpp"):
                        arguments.append(word)
            yield path, command["directory"], arguments

    def run(self, command, folder):
        """What clang says of what it refuses; "" of others."""
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, env=self.environment)
        return done.stderr or "refused" if done.returncode else ""

    def compile_header(self, folder, arguments):
        """The common header. The same text gives the same bytes, which ccache goes by."""
        text = os.path.join(ROOT, "tests", "clang", "common.h")
        return self.run(["clang++", "-x", "c++-header", "-w", "-Xclang", "-fno-pch-timestamp",
                         *arguments, text, "-o", self.header], folder)

    def object_of(self, path):
        return os.path.join(self.folder, os.path.relpath(path, ROOT).replace(os.sep, "_") + ".o")

    def compile(self, source):
        path, folder, arguments = source
        header = ["-include-pch", self.header] if "-fPIC" in arguments else []
        command = ["clang++", "-w", *header, *arguments]
        if not self.is_linked(path):
            return self.run([*command, "-fsyntax-only", path], folder)
        return self.run([*self.ccache, *command, "-c", path, "-o", self.object_of(path)], folder)

    def link(self, objects):
        """The program that makes pan files, with the libraries that panwright is linked with."""
        done = subprocess.run(["ninja", "-C", self.build, "-t", "commands", "bin/panwright"],
                              capture_output=True, text=True)
        if done.returncode:
            return f"how panwright is linked is not known: {done.stderr}"
        words = shlex.split(done.stdout.strip().splitlines()[-1])
        libraries = [word for word in words
                     if word.startswith("-l") or ".so" in word
                     or (word.endswith(".a") and os.path.isabs(word))]
        return self.run(["clang++", *objects, *libraries, "-o", self.program()], self.build)

    def folder_of(self, path):
        """The folder of the project, whether in its source or in its build."""
        root = self.build if path.startswith(self.build + os.sep) else ROOT
        return os.path.relpath(path, root).split(os.sep)[0]

    def is_linked(self, path):
        name = os.path.relpath(path, ROOT)
        if name in STEP_READER:
            return False
        return self.folder_of(path) in LINKED or name in (
            "workspace/open.cpp", "workspace/budget.cpp", "workspace/quantities.cpp",
            "tests/clang/pans.cpp")

    def program(self):
        return os.path.join(self.folder, "pans")


def outputs(folder, files):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    return [os.path.join(folder, os.path.basename(path) + ".pan") for path in files]


def written_by_gcc(program, files, threads, folder):
    """The pan files of `panwright compile` and `import`, or what could not be done."""
    made = outputs(folder, files)
    for path, output in zip(files, made):
        command = "compile" if path.endswith(".pxn") else "import"
        words = [program, command, path, "-o", output, "-j", str(threads), "--no-cache"]
        done = subprocess.run(words, capture_output=True, text=True)
        if not os.path.exists(output):
            print(f"{shlex.join(words)}\n{done.stderr}")
    return made


def compare(build, corpus):
    """The number of models whose four files are not alike."""
    files = list(models(corpus))
    ways = {}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for threads in (1, 8):
            folder = os.path.join(build.folder, f"gcc-{threads}")
            ways[f"gcc, {threads} threads"] = pool.submit(
                written_by_gcc, os.path.join(build.build, "bin", "panwright"), files, threads,
                folder)
            made = outputs(os.path.join(build.folder, f"clang-{threads}"), files)
            pairs = [word for pair in zip(files, made) for word in pair]
            ways[f"clang, {threads} threads"] = made
            pool.submit(subprocess.run, [build.program(), str(threads), *pairs])
    ways = {name: way.result() if hasattr(way, "result") else way for name, way in ways.items()}
    wrong = 0
    for i, path in enumerate(files):
        first, *others = [(name, made[i]) for name, made in ways.items()]
        missing = [name for name, made in (first, *others) if not os.path.exists(made)]
        differ = [] if missing else [name for name, made in others
                                     if not filecmp.cmp(first[1], made, shallow=False)]
        if missing or differ:
            print(f"{path}: {'none of ' + ' or '.join(missing) if missing else ''}"
                  f"{'differs from that of ' + first[0] + ': ' + ', '.join(differ) if differ else ''}")
            wrong += 1
    print(f"{len(files)} models, {wrong} not the same whatever the compiler and the threads")
    return wrong if files else 1


def main():
    if not shutil.which("clang++"):
        print("clang++ is not installed: nothing was read")
        return 77
    start = time.monotonic()
    build = Build(sys.argv[1])
    # a build with sanitizers by clang compiles the others (preset asan-clang)
    todo = [source for source in build.sources() if build.is_linked(source[0])]
    if not todo:
        print("no sources found")
        return 1
    # the arguments of a library that all can be linked with
    _, folder, arguments = next(each for each in todo if each[0].endswith("/workspace/open.cpp"))
    todo.append((os.path.join(ROOT, "tests", "clang", "pans.cpp"), folder, arguments))
    said = [build.compile_header(folder, arguments)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        said += [f"{source[0]}\n{text}" for source, text in zip(todo, pool.map(build.compile, todo))
                 if text]
    said = [text for text in said if text]
    print("\n".join(said))
    print(f"{len(todo)} sources, {len(said)} refused, {(time.monotonic() - start) / 60:.1f} min")
    if said:
        return 1
    refused = build.link([build.object_of(path) for path, _, _ in todo if build.is_linked(path)])
    if refused:
        print(refused)
        return 1
    wrong = compare(build, sys.argv[2] if len(sys.argv) > 2 else "")
    print(f"{(time.monotonic() - start) / 60:.1f} min")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
