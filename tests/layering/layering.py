#!/usr/bin/env python3
"""Reads every #include "folder/…" of the tree and fails on an edge that the architecture forbids."""

import pathlib
import re
import sys

# folder: what it may include directly; the table is closed transitively below
ALLOWED = {
    "base": [],
    "schemas": [],
    "image": ["base", "schemas"],
    "geometry": ["base", "schemas"],
    "materials": ["base", "schemas", "image"],
    "mli": ["geometry"],
    "scene": ["geometry", "materials", "mli"],
    "pan": ["geometry", "materials", "schemas"],
    "importers": ["scene", "image"],
    "exporters": ["pan", "image"],
    "compiler": ["scene", "pan"],
    "world": ["pan"],
    "preview": ["world", "image"],
    "pxn": ["scene", "importers", "schemas"],
    "workspace": ["pxn", "importers", "exporters", "compiler", "world", "preview"],
    "studio": ["workspace", "preview"],
    "tools": ["workspace", "studio", "mli"],
}
# The same below the first level: sub-folder: the sub-folders it may include, closed transitively. Files beside the
# sub-folders may include all of them; a sub-folder includes such a header only if that includes no more than itself may.
PARTS = {
    "geometry": {"internal": [], "kinematics": [], "ray": ["internal"], "mesh": ["ray"], "tessellate": ["internal"]},
    "importers": {"internal": [], "vrml": ["internal"], "gltf": ["internal"], "meshes": ["internal"], "step": ["internal"],
                  "urdf": ["internal"], "mjcf": ["internal"]},
    "materials": {"generated": [], "formulas": [], "presets": [], "internal": ["formulas", "generated"]},
    "preview": {"shaders": [], "gl": [], "model": ["gl"], "frame": ["model"], "reference": []},
    "pxn": {"text": [], "expression": ["text"], "reader": ["expression"]},
}
# includes that these tables forbid, each with its reason
EXCEPTIONS = {}
UNRESTRICTED = ["bench", "tests", "examples"]
NEVER_INCLUDED = ["tools", "bench"]
# Sub-folders that serve their folder alone; cmake/PanwrightInstall.cmake leaves them out too.
OWN = ("importers/vrml/", "importers/gltf/", "importers/meshes/", "importers/step/", "importers/urdf/", "importers/mjcf/", "pxn/text/", "pxn/expression/",
       "pxn/reader/", "preview/gl/", "preview/model/", "preview/frame/")
# The reference renderer is an oracle of the preview: of what the two could share it includes these
# alone, and calls none of what follows.
REFERENCE = "preview/reference/"
REFERENCE_INCLUDES = {
    "preview": ("reference/",),
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


def part_of(path):
    """The folder and its sub-folder that a path lies in; None: beside the sub-folders."""
    folder, *rest = path.split("/")
    return folder, rest[0] if len(rest) > 1 else None


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
    if parts is None or part_of(included)[0] != folder or (path, included) in EXCEPTIONS:
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


def problems(root):
    for path in sorted(root.rglob("*")):
        if path.suffix not in {".h", ".cpp", ".inl", ".def"} or not path.is_file():
            continue
        folder = path.relative_to(root).parts[0]
        if folder in UNRESTRICTED or folder not in ALLOWED:
            if folder not in UNRESTRICTED + ["build"]:
                yield f"{path.relative_to(root)}: lies in no known folder"
            allowed = None
        else:
            allowed = closure(folder) | {folder}
        if folder == "build":
            continue
        text = path.read_text(encoding="utf-8")
        for match in INCLUDE.finditer(text):
            target, rest = match.groups()
            line = text.count("\n", 0, match.start()) + 1
            where = f"{path.relative_to(root)}:{line}"
            yield from part_problems(root, str(path.relative_to(root)), line, f"{target}/{rest}")
            if allowed is not None and target in list(ALLOWED) + UNRESTRICTED and target not in allowed:
                yield f"{where}: {folder} must not include {target}/{rest}"
            if where.startswith(REFERENCE) and not rest.startswith(REFERENCE_INCLUDES.get(target, ("",))):
                yield f"{where}: the reference renderer must not include {target}/{rest}"
            if target in NEVER_INCLUDED and target != folder and folder not in ("tests",):
                yield f"{where}: nothing includes {target}/"
            # a private header serves the sources beside it and below
            home = f"{target}/{rest}".split("internal/")[0] if "internal/" in rest else None
            if f"{target}/{rest}".startswith(OWN) and target != folder:
                home = f"{target}/"
            if home and not where.startswith(home) and folder not in UNRESTRICTED:
                yield f"{where}: {target}/{rest} is private"
        if str(path.relative_to(root)).startswith(REFERENCE):
            for match in REFERENCE_CALLS.finditer(text):
                line = text.count("\n", 0, match.start()) + 1
                yield f"{path.relative_to(root)}:{line}: the reference renderer has its own {match.group(1)}()"
        if re.search(r"embree", text) and folder != "geometry" and "embree3/" in text:
            yield f"{path.relative_to(root)}: Embree is reached through geometry/ray/instances.h"


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "layering: ok")
    sys.exit(1 if found else 0)
