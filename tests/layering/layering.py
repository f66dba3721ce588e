#!/usr/bin/env python3
"""Reads every #include "folder/…" of the tree and fails on an edge that the architecture forbids."""

import pathlib
import re
import sys

# Folders by level, with what each may include directly; the table is closed transitively below. It is that of docs/map.md
# (problems_of_tables() compares them) and of the READMEs (tests/words/stated_names.py). A folder includes those of its own level or of lower ones.
LEVELS = [
    {"base": [], "schemas": []},
    {"image": ["base", "schemas"], "geometry": ["base", "schemas"], "materials": ["image", "schemas"], "ephemeris": ["base"]},
    {"mli": ["geometry"], "light": ["materials"], "sensor": ["base"], "scene": ["geometry", "materials", "mli"], "pan": ["geometry", "materials", "schemas"], "terrain": ["image", "ephemeris", "pan"]},
    {"importers": ["scene", "image"], "exporters": ["pan", "image"], "compiler": ["scene", "pan"], "world": ["pan", "light", "sensor"],
     "pxn": ["scene", "importers", "schemas"]},
    {"trace": ["world", "terrain"], "scenario": ["world", "ephemeris"], "sky": ["world", "image"]},
    {"labels": ["trace", "sky", "image"], "transport": ["trace", "sky"], "preview": ["sky", "world", "image"], "preview/reference": ["trace", "image"],
     "instruments": ["labels", "preview/reference", "sensor"]},
    {"workspace": ["pxn", "importers", "exporters", "compiler", "world", "sky", "scenario", "labels", "instruments", "sensor", "transport",
                   "preview", "preview/reference"]},
    {"studio": ["workspace", "preview"], "server": ["workspace", "trace"], "tools": ["workspace", "studio", "server", "mli", "terrain"]},
    {"python": ["workspace", "tools", "mli"]},
]
ALLOWED = {room: targets for level in LEVELS for room, targets in level.items()}
# The same below the first level: sub-folder: the sub-folders it may include, closed transitively. Files beside the
# sub-folders may include all of them; a sub-folder includes such a header only if that includes no more than itself may.
# Those of BESIDE belong to a sub-folder as if they lay in it.
PARTS = {
    "geometry": {"internal": [], "kinematics": [], "ray": ["internal"], "mesh": ["ray"], "tessellate": ["internal"]},
    "importers": {"internal": [], "vrml": ["internal"], "gltf": ["internal"], "meshes": ["internal"], "step": ["internal"],
                  "urdf": ["internal"], "mjcf": ["internal"]},
    "materials": {"generated": [], "formulas": [], "presets": [], "internal": ["formulas", "generated"]},
    "preview": {"shaders": [], "gl": [], "model": ["gl"], "frame": ["model"], "reference": []},
    "image": {"internal": []},
    "sensor": {"internal": []},
    "server": {"internal": []},
    "transport": {"internal": []},
    "ephemeris": {"internal": []},
    "terrain": {"internal": [], "gdal": ["internal"]},
    "scenario": {"internal": []},
    "labels": {"internal": [], "formats": ["internal"]},
    "instruments": {"internal": []},
    "pxn": {"text": [], "expression": ["text"], "reader": ["expression"]},
}
BESIDE = {"preview/context": "gl", "preview/device": "model", "preview/renderer": "frame"}
# includes that these tables forbid, each with its reason
EXCEPTIONS = {}
UNRESTRICTED = ["bench", "tests", "examples"]
NEVER_INCLUDED = ["tools", "bench"]
# Sub-folders that serve their folder alone; cmake/PanwrightInstall.cmake leaves them out too.
OWN = ("importers/vrml/", "importers/gltf/", "importers/meshes/", "importers/step/", "importers/urdf/", "importers/mjcf/", "pxn/text/", "pxn/expression/",
       "pxn/reader/", "preview/gl/", "preview/model/", "preview/frame/", "labels/formats/")
# The reference renderer and its rays are an oracle of the preview: of what they could share they include
# these alone, and call none of what follows.
REFERENCE = ("preview/reference/", "trace/")
REFERENCE_INCLUDES = {
    "image": ("image.h",),
    "world": ("world.h", "camera.h"),
    "geometry": ("ray/", "mesh.h"),
}
REFERENCE_CALLS = re.compile(
    r"\b(world_from_nodes|world_from_frame|parent_from_node|pixel_ray|pixel_solid_angle|pixel_area|project"
    r"|srgb_decoded|srgb_code|matrix_from_trs|cofactor|mat3_cast)\(")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([a-z_]+)/([^"]+)"', re.M)


def closure(folder, seen=None, table=ALLOWED):
    seen = seen if seen is not None else set()
    for target in table[folder]:
        if target not in seen:
            seen.add(target)
            closure(target, seen, table)
    return seen


def room_of(path):
    """The folder of the table in which a path lies."""
    return next((room for room in ALLOWED if "/" in room and path.startswith(room + "/")), path.split("/")[0])


def part_of(path):
    """The folder and its sub-folder that a path lies in or belongs to; None: beside the sub-folders."""
    folder, *rest = path.split("/")
    return folder, rest[0] if len(rest) > 1 else BESIDE.get(path.rsplit(".", 1)[0])


def parts_of(root, path):
    """The sub-folders that a header of a folder includes, itself or by others of the folder."""
    folder, _ = part_of(path)
    found = set()
    for target, rest in INCLUDE.findall((root / path).read_text(encoding="utf-8")):
        part = part_of(f"{target}/{rest}")[1]
        if target == folder:
            found |= {part} if part in PARTS[folder] else parts_of(root, f"{target}/{rest}")
    return found


def part_problems(root, path, line, included):
    """One include of a folder by itself, below the first level."""
    folder, part = part_of(path)
    parts = PARTS.get(folder)
    if parts is None or room_of(included) != room_of(path) or (path, included) in EXCEPTIONS:
        return
    target = part_of(included)[1]
    for each in (part, target):
        if each is not None and each not in parts:
            yield f"{path}:{line}: {folder}/{each}/ lies in no known part of {folder}"
            return
    if part is None:
        return
    allowed = closure(part, None, parts) | {part}
    if target is None:
        if (root / included).is_file() and not parts_of(root, included) <= allowed:
            yield f"{path}:{line}: {included} includes parts of {folder} that {folder}/{part} must not include"
    elif target not in allowed:
        yield f"{path}:{line}: {folder}/{part} must not include {included}"


def problems_of_file(root, path, text):
    """What one file includes and calls that it must not. path: from the root, in letters."""
    room = room_of(path)
    allowed = closure(room) | {room} if room in ALLOWED else None
    for match in INCLUDE.finditer(text):
        target, rest = match.groups()
        included = f"{target}/{rest}"
        line = text.count("\n", 0, match.start()) + 1
        yield from part_problems(root, path, line, included)
        where = f"{path}:{line}"
        if allowed is not None and room_of(included) in list(ALLOWED) + UNRESTRICTED and room_of(included) not in allowed:
            yield f"{where}: {room} must not include {included}"
        if path.startswith(REFERENCE) and not rest.startswith(REFERENCE_INCLUDES.get(target, ("",))):
            yield f"{where}: the reference renderer must not include {included}"
        folder = part_of(path)[0]
        if target in NEVER_INCLUDED and target != folder and folder not in ("tests", "python"):
            yield f"{where}: nothing includes {target}/"
        # a private header serves the sources beside it and below
        home = included.split("internal/")[0] if "internal/" in included else None
        if included.startswith(OWN) and target != folder:
            home = f"{target}/"
        if home and not path.startswith(home) and folder not in UNRESTRICTED:
            yield f"{where}: {included} is private"
    if path.startswith(REFERENCE):
        for match in REFERENCE_CALLS.finditer(text):
            line = text.count("\n", 0, match.start()) + 1
            yield f"{path}:{line}: the reference renderer has its own {match.group(1)}()"
    if "embree3/" in text and part_of(path)[0] != "geometry":
        yield f"{path}: Embree is reached through geometry/ray/instances.h"


def problems_of_tables(root):
    """The table against itself and docs/map.md."""
    for number, level in enumerate(LEVELS):
        below = {room for each in LEVELS[:number + 1] for room in each}
        for room, targets in level.items():
            for target in set(targets) - below:
                yield f"layering.py: {room} of level {number} includes {target} of a higher one"
            if room in closure(room):
                yield f"layering.py: {room} includes itself, by others"
    text = (root / "docs/map.md").read_text(encoding="utf-8")
    table = text[text.index("Who may include whom"):].split("```")[1]
    edges = {}
    for level, line in re.findall(r"^(\d)  (.*)$", table, re.M):
        for entry in re.split(r"   +", line):
            room, _, targets = entry.partition(" → ")
            edges[room.split(" (")[0].strip()] = (int(level), set(targets.split(", ")) - {""})
    ours = {room: (number, set(targets)) for number, level in enumerate(LEVELS) for room, targets in level.items()}
    for room in sorted(set(edges) | set(ours)):
        if edges.get(room) != ours.get(room):
            yield f"docs/map.md: {room}: {edges.get(room)}, but {ours.get(room)} in layering.py"


def problems_of_cycles(root, headers):
    """Headers that include themselves, by others."""
    done = set()

    def walk(path, above):
        if path in above:
            yield f"{path}: includes itself, by " + ", ".join(above[above.index(path) + 1:])
        elif path in headers and path not in done:
            for target, rest in INCLUDE.findall(headers[path]):
                yield from walk(f"{target}/{rest}", above + [path])
            done.add(path)

    for path in headers:
        yield from walk(path, [])


def problems(root):
    headers = {}
    for file in sorted(root.rglob("*")):
        path = str(file.relative_to(root))
        folder = part_of(path)[0]
        if folder == "build" or file.suffix not in {".h", ".cpp", ".inl", ".def"} or not file.is_file():
            continue
        if folder not in UNRESTRICTED and folder not in ALLOWED:
            yield f"{path}: lies in no known folder"
        text = file.read_text(encoding="utf-8")
        if file.suffix != ".cpp":
            headers[path] = text
        yield from problems_of_file(root, path, text)
    yield from problems_of_cycles(root, headers)
    yield from problems_of_tables(root)


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "layering: ok")
    sys.exit(1 if found else 0)
