#!/usr/bin/env python3
"""Checks that files named in comments and folder READMEs exist, that codes of diagnostics are in the registry, and that each README states its folder's
contract."""

import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "layering"))
import layering
import words

SOURCES = {".h", ".cpp", ".inl", ".def", ".glsl", ".vert", ".frag", ".geom", ".comp"}
NAME = re.compile(r"(?<![\w/.*<…-])((?:[\w-]+/)*(?!\w*NAME)[\w-]{2,}\.(?:h|cpp|inl|def|glsl|vert|frag|geom|comp|py|toml|md|cmake))\b(?![\w/*…])")
# of a library, and of the public corpus
FOREIGN = {"glad/gl.h", "MANIFEST.md"}
MOST_LINES = 30
CTEST = re.compile(r"ctest [^`]*-R '([^']+)'")
TEST = re.compile(r"(?:panwright_test\(|add_test\(NAME )(\w+)")


def tree(root):
    """Paths of the project's files, from the root."""
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "-co", "--exclude-standard"], capture_output=True, text=True)
    if listed.returncode == 0:
        return [path for path in listed.stdout.splitlines() if (root / path).is_file()]
    return [str(path.relative_to(root)) for path in root.rglob("*") if path.is_file() and path.relative_to(root).parts[0] != "build"]


def endings(paths):
    """Every path by each of its ends: 'a/b/c.h', 'b/c.h', 'c.h'."""
    out = set()
    for path in paths:
        parts = path.split("/")
        out.update("/".join(parts[i:]) for i in range(len(parts)))
    return out


def comment_problems(root, paths, known):
    for path in paths:
        if pathlib.PurePath(path).suffix not in SOURCES:
            continue
        for comment in words.comments((root / path).read_text(encoding="utf-8")):
            for offset, text in enumerate(comment["lines"]):
                for name in NAME.findall(text):
                    if name not in known and name not in FOREIGN:
                        yield f"{path}:{comment['line'] + offset}: names {name}, which does not exist"


def code_problems(root, paths):
    registry = set(re.findall(r"^PANWRIGHT_CODE\((\w+)", (root / "base/diagnostic_codes.def").read_text(encoding="utf-8"), re.M))
    for path in paths:
        if pathlib.PurePath(path).suffix not in SOURCES:
            continue
        for name in re.findall(r'\bCode\("(\w+)"\)', (root / path).read_text(encoding="utf-8")):
            if name not in registry:
                yield f"{path}: Code(\"{name}\") is not in base/diagnostic_codes.def"


def readme_problems(root, folder, known, tests):
    path = root / folder / "README.md"
    where = f"{folder}/README.md"
    if not path.is_file():
        yield f"{where}: missing"
        return
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    if not re.match(rf"# {folder}: \S", lines[0]) or len(lines) < 3 or not lines[2].strip():
        yield f"{where}: begins with '# {folder}: purpose', then a paragraph"
    if len(lines) > MOST_LINES:
        yield f"{where}: {len(lines)} lines, at most {MOST_LINES}"
    first = re.search(r"^Read first: `([^`]+)`", text, re.M)
    if not first or not (root / folder / first.group(1)).is_file():
        yield f"{where}: no 'Read first: `header.h`' of a header in the folder"
    include = re.search(r"May include: ([^.\n]*)\.(?:\s|$)", text)
    stated = re.findall(r"`([\w/]+)`", include.group(1)) if include else None
    if stated is None or sorted(stated) != sorted(layering.ALLOWED[folder]):
        yield f"{where}: 'May include:' is {stated}, tests/layering/layering.py has {layering.ALLOWED[folder]}"
    run = CTEST.search(text)
    if not re.search(r"^Tests: ", text, re.M) or not run:
        yield f"{where}: no 'Tests: `ctest … -R '…'`'"
    elif not any(re.search(run.group(1), name) for name in tests):
        yield f"{where}: '{run.group(1)}' is no test"
    for name in re.findall(r"`([^`\s]+)`", text):
        if re.fullmatch(NAME, name) and name not in known:
            yield f"{where}: names {name}, which does not exist"
        elif re.fullmatch(r"[\w/-]+/", name) and not ((root / folder / name).is_dir() or (root / name).is_dir()):
            yield f"{where}: names {name}, which does not exist"


def problems(root):
    paths = tree(root)
    known = endings(paths)
    yield from comment_problems(root, paths, known)
    yield from code_problems(root, paths)
    tests = set()
    for path in paths:
        if path.startswith("tests/") and path.endswith("CMakeLists.txt"):
            tests.update(TEST.findall((root / path).read_text(encoding="utf-8")))
    for folder in layering.ALLOWED:
        yield from readme_problems(root, folder, known, tests)


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "stated_names: ok")
    sys.exit(1 if found else 0)
