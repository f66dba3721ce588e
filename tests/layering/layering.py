#!/usr/bin/env python3
"""Reads every #include "folder/…" of the tree and fails on an edge that the architecture forbids."""

import pathlib
import re
import sys

# folder: what it may include directly; the table is closed transitively below
ALLOWED = {
    "base": [],
    "schemas": [],
    "geometry": ["base", "schemas"],
    "materials": ["base", "schemas"],
    "mli": ["geometry"],
    "scene": ["geometry", "materials", "mli"],
    "pan": ["geometry", "materials", "schemas"],
    "importers": ["scene"],
    "exporters": ["pan"],
    "compiler": ["scene", "pan"],
    "world": ["pan"],
    "preview": ["world"],
    "pxn": ["scene", "importers", "schemas"],
    "workspace": ["pxn", "importers", "exporters", "compiler", "world", "preview"],
    "studio": ["workspace", "preview"],
    "tools": ["workspace", "studio", "mli"],
}
UNRESTRICTED = ["bench", "tests", "examples"]
NEVER_INCLUDED = ["tools", "bench"]
# Sub-folders that serve their folder alone; cmake/PanwrightInstall.cmake leaves them out too.
OWN = ("importers/vrml/", "importers/gltf/", "importers/meshes/", "importers/step/", "importers/urdf/", "importers/mjcf/", "pxn/text/", "pxn/expression/",
       "pxn/reader/", "preview/gl/", "preview/image/", "preview/model/", "preview/frame/")
# The reference renderer is an oracle of the preview: of what the two could share it includes these
# alone, and calls none of what follows.
REFERENCE = "preview/reference/"
REFERENCE_INCLUDES = {
    "preview": ("image.h", "reference/"),
    "world": ("world.h", "camera.h"),
    "geometry": ("ray/", "mesh.h"),
}
REFERENCE_CALLS = re.compile(
    r"\b(world_from_nodes|world_from_frame|parent_from_node|pixel_ray|pixel_solid_angle|pixel_area|project"
    r"|srgb_decoded|srgb_code|matrix_from_trs|cofactor|mat3_cast)\(")
INCLUDE = re.compile(r'^\s*#\s*include\s+"([a-z_]+)/([^"]+)"', re.M)


def closure(folder, seen=None):
    seen = seen if seen is not None else set()
    for target in ALLOWED[folder]:
        if target not in seen:
            seen.add(target)
            closure(target, seen)
    return seen


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
