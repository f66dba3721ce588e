#!/usr/bin/env python3
"""Holds files to 600 lines and functions to 80, except for those listed here."""

import pathlib
import re
import sys

import sources

MOST_FILE_LINES = 600
MOST_FUNCTION_LINES = 80
# file, or file:function: the reason. An exception that is not needed fails.
EXCEPTIONS = {
    "tests/diagnostics/coverage_test.cpp:command_lines": "a list of command lines",
    "tests/geometry/shape_warnings_test.cpp:ShapeWarnings": "a list of shapes",
    "tests/importers/mjcf/mjcf_bad_test.cpp:MjcfBad": "a list of bad files",
    "tests/importers/urdf/urdf_bad_test.cpp:UrdfBad": "a list of bad files",
    "tests/pxn/dimensions_test.cpp:Kinds": "a list of expressions",
    "tests/pxn/expression_test.cpp:Expression": "a list of expressions",
}
NOT_FUNCTION = re.compile(r'(inline\s+)?namespace\b|extern\s*""|(typedef\s+)?(struct|class|union|enum)\b')
ACCESS = re.compile(r"^((public|private|protected)\s*:\s*)+")


def is_function(head, around):
    head = ACCESS.sub("", head)
    head = re.sub(r"^template\s*<[^{]*?>\s*(?=struct|class)", "", head)
    return "(" in head and not head.endswith("=") and not NOT_FUNCTION.match(head) \
        and not any(is_function(each, []) for each in around)


def name_of(head):
    if test := re.match(r"(?:TYPED_)?TEST(?:_[FP])?\((\w+)", head):
        return test.group(1)
    return re.search(r"([\w~]+|operator\S+)\s*\(", head).group(1)


def problems(root):
    needed = set()
    for path in sources.listed(root):
        text = (root / path).read_text(encoding="utf-8")
        lines = text.count("\n")
        if lines > MOST_FILE_LINES:
            needed.add(path)
            if path not in EXCEPTIONS:
                yield f"{path}: {lines} lines, at most {MOST_FILE_LINES}: divide it by idea"
        try:
            for head, first, last, around in sources.blocks(sources.bare(text)):
                if last is None or last - first < MOST_FUNCTION_LINES or not is_function(head, around):
                    continue
                exception = f"{path}:{name_of(head)}"
                needed.add(exception)
                if exception not in EXCEPTIONS:
                    yield f"{path}:{first}: {name_of(head)} has {last - first + 1} lines, at most {MOST_FUNCTION_LINES}"
        except ValueError as error:
            yield f"{path}: {error}"
    for exception in sorted(set(EXCEPTIONS) - needed):
        yield f"tests/layering/caps.py: the exception {exception} is not needed"


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "caps: ok")
    sys.exit(1 if found else 0)
