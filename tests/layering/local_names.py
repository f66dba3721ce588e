#!/usr/bin/env python3
"""Refuses a name that is local to two sources of one target: unity builds compile them as one.

Local: in an anonymous namespace, or static at file level. A target's sources are those of a folder
and its sub-folders; sources with a namespace of their own may repeat names. Overloads count as one
name: a call would choose among them in one build, and not in the other.
"""

import pathlib
import re
import sys

import sources

ANONYMOUS = re.compile(r"^(inline\s+)?namespace$")
NAMESPACE = re.compile(r"^(?:inline\s+)?namespace\s+([\w:\s]+)$")
TYPE = re.compile(r"(?:struct|class|union|enum(?:\s+(?:class|struct))?)\s+(?:alignas\(\w+\)\s*)?(\w+)")
IGNORED = re.compile(r"^(namespace\b|using\b|static_assert\b|template\b.*\boperator|friend\b|extern\b|TEST|TYPED_TEST|INSTANTIATE|MATCHER)|\boperator\b", re.S)
# target of sources that are none of their folder's
OTHERS = {
    "importers/step/internal/": "panwright_step_reader",
    "importers/step/main.cpp": "panwright_step",
    "tools/main.cpp": "panwright_tool",
}


def target_of(path):
    for prefix, target in OTHERS.items():
        if path.startswith(prefix):
            return target
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] in ("tests", "examples") else parts[0]


def without_angles(text):
    before = None
    while before != text:
        before = text
        text = re.sub(r"<[^<>()]*>", "", text)
    return re.sub(r"<[^<>]*\([^()]*\)[^<>]*>", "", text)


def name_of(head, is_block):
    head = re.sub(r"\[\[[^\]]*\]\]", "", head)
    if IGNORED.search(head):
        return None
    if head.startswith("template"):
        head = re.sub(r"^(template\s*)+", "", without_angles(head))
    found = TYPE.match(head)
    if found and is_block and "(" not in head.replace("alignas(", ""):
        return found.group(1)
    if found and not is_block and head == found.group():
        return None  # declared beforehand
    head = without_angles(re.split(r"(?<![=!<>])=(?!=)", head)[0])
    found = re.search(r"([\w:~]+)\s*\(", head) or re.search(r"([\w:]+)\s*(?:\[[^\]]*\]\s*)*$", head)
    if not found or "::" in found.group(1) or not found.group(1)[0].isalpha() or found.group(1) in ("struct", "class", "union", "enum"):
        return None
    return found.group(1)


def local_names(text):
    """Yields (namespaces, name, line)."""
    for head, line, last, around in sources.blocks(text):
        if not all(ANONYMOUS.match(each) or NAMESPACE.match(each) for each in around):
            continue
        if ANONYMOUS.match(head) or NAMESPACE.match(head):
            continue
        inside = any(ANONYMOUS.match(each) for each in around)
        if not inside and not re.match(r"(\[\[\w+\]\]\s*)?static\b", head):
            continue
        name = name_of(head, last is not None)
        if name:
            yield "::".join(NAMESPACE.match(each).group(1) for each in around if NAMESPACE.match(each)), name, line


def problems(root):
    known = {}
    for path in sources.listed(root, (".cpp",)):
        for namespaces, name, line in local_names(sources.bare((root / path).read_text(encoding="utf-8"))):
            first = known.setdefault((target_of(path), namespaces, name), (path, line))
            if first[0] != path:
                yield f"{path}:{line}: {name} is local to {first[0]}:{first[1]} too"


if __name__ == "__main__":
    found = sorted(set(problems(pathlib.Path(sys.argv[1]))))
    print("\n".join(found) or "local_names: ok")
    sys.exit(1 if found else 0)
