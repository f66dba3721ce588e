"""What every command prints with --json: the one description, of which generate_json.py makes schemas and the page.

A field is NAME: "TYPE: what it is", with NAME? where it may be missing even after success. Types: number, integer, string,
boolean, object (of any members), vec3, any; T[] a list of T; T|null. A tuple (words, {fields}) is an object, (words, [{fields}])
a list of objects. Other fields are there whenever the exit code is 0.
"""

DIAGNOSTIC = {
    "code": "string: E1101; `panwright explain` says more",
    "severity": "string: error, warning or note",
    "message": "string: what is wrong, what was found, what would be accepted",
    "file?": "string: the file that it is about",
    "line?": "integer: from 1",
    "column?": "integer: from 1, in characters",
    "end_line?": "integer: of the end of what is marked",
    "end_column?": "integer: of the end of what is marked",
    "object?": "string: path in the model, as group[2]/mesh",
    "hint?": "string: did you mean …",
    "included_from?": ("the includes that lead to the file, innermost first", [{"file": "string: the file", "line": "integer: of the include"}]),
}

COMMON = {
    "schema": "integer: the version of the schema: the number that schema_id ends with",
    "schema_id": "string: panwright/COMMAND/VERSION, the name of the schema",
    "command": "string: the command; `usage` where none was understood",
    "exit_code": "integer: docs/conventions.md 18",
    "errors": "integer: how many",
    "warnings": "integer: how many",
    "notes": "integer: how many",
    "hidden": "integer: diagnostics over the limit, which are not listed",
    "diagnostics": ("what was found, file by file, from top to bottom", [DIAGNOSTIC]),
    "timings_ms?": "object: with --timings: milliseconds of each step by its name",
    "written?": "string[]: the files that were written",
}

MATERIAL = {
    "name": "string: as in its file",
    "brdf": "string: its BRDF models in words",
    "laws": "string: the same, as it was called",
    "back": "string|null: the material of its back; null: as itself",
    "directional_albedo": ("by cosine", [{"mu": "number: cosine of the angle to the normal", "rgb": "vec3: mean over the azimuth, at 650, 550, 450 nm",
                                        "least": "vec3: least over the azimuth", "largest": "vec3: largest over the azimuth"}]),
    "hemispherical_albedo": "vec3: at 650, 550, 450 nm",
    "largest_albedo": ("the largest directional albedo", {"albedo": "number: energy is kept up to 1", "mu": "number: its cosine"}),
    "reciprocity_residual": "number: largest, relative",
    "fit_error": "number: largest approximation error; 0 where nothing is approximated",
    "f32_error": ("of single precision, relative", {"max": "number: largest", "rms": "number: RMS"}),
    "ns_per_evaluation": ("nanoseconds, one core", {"f64": "number: in double precision", "f32": "number: in single precision"}),
    "solar_absorptance": ("0.3 to 2.5 µm", {"computed": "number|null: from n and k", "published": "number|null: by the material's source"}),
    "provenance": ("where its numbers come from", {"source": "string: who published them", "published": "string: what is as published",
                                                   "fitted": "string: what was fitted", "indicative": "string: what is a guess"}),
}

STORAGE = ("of positions, normals and indices: --compress", {
    "form": "string: none, lossless, quantised:16, meshopt, draco:14 …", "bytes": "integer: of their streams; 0 of none and lossless",
    "position_error": "number: metres in the frame of a mesh: no vertex was moved further", "normal_error": "number: degrees: no normal was turned further",
    "meshes_with_more_bits": "integer: than asked, for their tolerance"})

REUSED = {"reused": "integer: from the cache", "made": "integer: anew"}
CACHE = ("where there is one: results of work that is worth keeping", {
    "whole": "boolean: the whole file is that of an earlier import, and no part was looked at",
    "meshes": ("triangles for exact shapes", REUSED), "levels": ("levels of detail of meshes", REUSED), "simplified": ("meshes made coarser for the budget", REUSED),
    "foil": ("sheets and blankets", REUSED), "cleaned": ("meshes of CAD files", REUSED)})

OPTIONAL = lambda fields: {(name if name.endswith("?") else name + "?"): what for name, what in fields.items()}

TOLERANCE = {"tolerance": "number|null: metres that were asked for", "ratio": "number|null: error by tolerance", "reason": "string: what decided it"}

BUDGET = {
    "tolerance": "number|null: metres", "nearest": "number|null: metres", "ifov": "number|null: radians", "pixels": "number|null: of silhouettes",
    "flux": "number|null: relative", "centroid": "number|null: pixels", "smallest_tolerance": "number|null: metres, the finest in the model",
    "gives": ("metres that terms amount to", {"pixels": "number|null: of silhouettes", "centroid": "number|null: of photocentres"}),
    "meshes_decided_by": "object: number of meshes by what decided their tolerance",
}

JOINTS = ("by node; values in radians, metres and factors", [{
    "name": "string: its own", "type": "string: fixed, revolute, continuous, prismatic, ball, general or scale", "node": "integer: index", "path": "string: of the node",
    "axis": "vec3: unit, of the node", "lower": "number[]|null: limits of each value", "upper": "number[]|null: limits of each value", "initial": "number[]: values",
    "value": "number[]: values that it has", "mimic": "string|null: the joint that it follows", "multiplier?": "number: with mimic", "offset?": "number: with mimic",
    "pointing": "vec3|null: what it aims, unit, of the node", "gimbal": "string|null: the joint that aims with it", "point_at": "string: sun or nothing"}])
CODE = {"code": "string: E1101", "severity": "string: error, warning or note", "title": "string: the problem as a noun phrase",
        "explanation": "string: what it means and what to do", "example": "string: what brings it about", "cure": "string: what helps"}

FITTED = ("of a model with a budget: what it asked for and what came of it", {
    "asked": ("its terms", {
        "tolerance": "number|null: metres", "nearest": "number|null: metres", "ifov": "number|null: radians", "pixels": "number|null: of silhouettes",
        "flux": "number|null: relative", "centroid": "number|null: pixels", "approach": "string|null: frame", "corridor": "number|null: radians"}),
    "achieved": ("bounds", {
        "error": "number: metres, in a mesh's own frame", "pixels": "number|null: the largest error of a part, at its nearest",
        "flux_left_out": "number: of the model's", "flux_simplified": "number: of the model's, what simplified meshes are off", "flux_shapes": "number: of the model's, what shapes may be off", "centroid_left_out": "number|null: pixels"}),
    "pieces": "integer: parts of the model", "pieces_left_out": "integer: of them", "triangles_left_out": "integer: of meshes, instances counted",
    "seconds": "number: leaving out and simplifying took",
    "parts": ("meshes of the file, from the most triangles", [{
        "name": "string: of the first node", "mesh": "string: in the file", "instances": "integer: of it", "triangles": "integer: instances counted",
        "bytes": "integer: of vertices and indices", "nearest": "number|null: metres from the camera", "tolerance": "number|null: metres in the world, null: as given",
        "reason": "string: the term that decided", "error": "number: metres in the world, bound", "seconds": "number: of one core"}]),
    "left_out": ("from the largest area", [{"name": "string: of the node", "pieces": "integer: parts", "triangles": "integer: of meshes", "area": "number: m^2, the largest that they show, summed"}]),
    "simplified": ("from the most triangles saved", [{"name": "string: of the first node", "before": "integer: triangles", "after": "integer: triangles",
        "error": "number: metres in its own frame, bound", "flux": "number: diffuse, relative", "normals": "number: radians, RMS", "seconds": "number: of one core"}]),
})

COMMANDS = {
    "compile": {
        "output": "string: the pan file", "bytes": "integer: its size", "triangles": "integer: as drawn, instances counted",
        "unique_triangles": "integer: as stored", "unique_meshes": "integer: as stored", "instances": "integer: of meshes",
        "worst_error": "number: metres, largest distance between mesh and shape",
        "budget?": FITTED,
        "storage": STORAGE,
        "cache?": CACHE,
    },
    "import": {
        "storage?": STORAGE,
        "format?": "string: without -o: the format of the file", "nodes?": "integer: without -o", "instances?": "integer: without -o",
        "mesh_triangles?": "integer: without -o, as stored in the file", "textures?": "integer: without -o", "joints?": "integer: without -o",
        "size?": "vec3: without -o: extent, metres",
        "materials?": ("without -o: what each material would become", [{
            "name": "string: in the file", "preset": "string: of the library", "reason": "string: of the guess", "triangles": "integer: of meshes that wear it", "area": "number: of these, m^2", "lost": "string[]: properties that are ignored"}]),
        "output?": "string: the file of -o", "bytes?": "integer: of a pan file", "triangles?": "integer: as drawn", "unique_triangles?": "integer: as stored",
        "budget?": FITTED,
        "removed?": ("hidden parts", {
            "triangles_before": "integer: before", "triangles_after": "integer: after", "instances_before": "integer: before", "instances_after": "integer: after",
            "rays": "integer: cast", "open_share_95": "number: 95 % bound of what is visible through a removed triangle", "seconds": "number: it took",
            "cached": "boolean: found by an earlier run"}),
        "cache?": CACHE,
    },
    "export": {"output": "string: the glTF file", "bytes": "integer: its size"},
    "check": {
        "files": ("in the order of the command line", [{
            "file": "string: as typed", "ok": "boolean: no errors", "errors": "integer: how many", "warnings": "integer: how many",
            "format?": "string: of a pan file, as 1.1", "compressed?": "boolean: of a pan file"}]),
    },
    "info": {
        "file": "string: as typed", "bytes": "integer: of the pan file, or of what would be one", "format": "string: of the pan file", "compressed": "boolean: it is", "storage?": "string: of meshes stored as streams: how, and what it moved",
        "build_id": "string: 32 hexadecimal digits; equal for equal models and inputs", "version": "string: of the program that made it",
        "options": "string: that it was made with", "triangles": "integer: as drawn", "vertices": "integer: as drawn", "unique_triangles": "integer: as stored",
        "unique_vertices": "integer: as stored", "error": "number: metres, largest distance between mesh and shape",
        "bounds": ("metres, world axes", {"min": "vec3|null: lowest corner", "max": "vec3|null: highest corner"}),
        "nodes": ("parents first", [{"name": "string: its own", "parent": "integer|null: index", "translation": "number[]: x y z, metres",
                                     "rotation": "number[]: as stored", "scale": "number[]: x y z"}]),
        "joints": JOINTS,
        "instances": ("of meshes", [{"node": "integer: index", "mesh": "integer: index", "material": "integer: index", "texture": "integer|null: index",
                                     "back?": "integer: index of the material of its back", "source?": "string: file:line:column"}]),
        "budget": "object|null: what the model asks for, as `gives` and by term", "need": "object|null: the same, as it was called",
        "materials": "object[]: name, models, parameters as schemas/material.toml names them, maps",
        "meshes": ("as stored", [{"name": "string: its own", "triangles": "integer: how many", "vertices": "integer: how many", "error": "number: metres, own frame",
                                  "budget": "object|null: tolerance, ratio of error to it, reason", "need": "object|null: the same, as it was called",
                                  "closed": "boolean: no boundary"}]),
        "textures": ("as stored", [{"name": "string: its file", "width": "integer: pixels", "height": "integer: pixels"}]),
        "frames": ("of the model", [{"name": "string: its own", "node": "integer: index", "origin": "vec3: metres, world axes", "right": "vec3: unit", "forward": "vec3: unit"}]),
        "inputs": ("files that it was made from", [{"path": "string: from the model's folder", "bytes": "integer: size", "xxh3": "string: hash, 32 digits"}]),
        "keypoints": ("of the model", [{"name": "string: its own", "node": "integer: index", "position": "vec3: metres, of the node", "world": "vec3: metres, world axes"}]),
        "decals": "object[]: name, instance, texture, origin, rotation, width, height, depth",
        "sheets": ("of foil", [{"mesh": "integer: index", "form": "string: flat, tube, cone, disc, box or wrap", "seed": "integer: of its recipe", "width": "number: metres", "height": "number: metres",
                                "cells": "number[]: along width and height", "heights": "number[]: lowest and highest, metres", "height_mean": "number: metres", "height_rms": "number: metres",
                                "slope_mean": "number[]: along x and y", "slope_covariance": "number[]: xx, xy, yy", "facet_slope_covariance": "number[]: the same of triangles",
                                "slope_rms": "number: both axes together", "correlation_length": "number[]: along x and y, metres"}]),
        "levels": ("of detail, by instance", [{"instance": "integer: index", "mesh": "integer: index", "material": "integer: index", "detail": "number: metres that a pixel sees, from which it is drawn",
                                "error": "number: metres", "triangles": "integer: of the mesh"}]),
        "sections": ("of the pan file", [{"kind": "integer: number", "name": "string: of the kind", "read": "boolean: this program reads it", "count": "integer: elements",
                                          "element_bytes": "integer: of one", "bytes": "integer: raw", "stored_bytes": "integer: in the file", "compressed": "boolean: it is"}]),
    },
    "joints": {
        "file": "string: as typed", "joints": JOINTS,
        "nodes": ("parents first", [{"name": "string: its path", "world_pose": "number[][]: world_from_node, four rows of four"}]),
        "sweep?": ("with --sweep", [{"joint": "string: its name", "from": "number: radians, metres or a factor", "to": "number: the same",
                                     "positions": "integer: how many", "min": "vec3: lowest corner of what moves, metres", "max": "vec3: highest corner",
                                     "collisions": "object[]: a and b, paths of nodes that meet; first and last value; positions"}]),
    },
    "render": {
        "gl?": ("with --engine gl", {"renderer": "string: by the driver", "version": "string: by the driver", "hardware": "boolean: no software"}),
        "images": ("that were written", [{
            "output": "string: the file", "width": "integer: pixels", "height": "integer: pixels", "unit": "string: of radiance: W/(m^2 sr) or 1/sr",
            "samples?": "number: mean of a pixel; with the reference engine in all", "pixel_error?": "number: estimated, RMS by RMS",
            "shadow_edge?": "number: pixels: 99 of 100 points of edges of shadows are nearer; with --engine gl",
            "penumbra?": "number: pixels: the widest that what may throw shadows can have; with --engine gl, shadows of the Sun's disc",
            "sun_points?": "integer: points of the Sun's disc that stand for it, where they are fewest; 1: shadows have hard edges",
            "programs?": "integer: shader programs that this image was the first to need; with --engine gl",
            "programs_ms?": "number: that building them took",
            "imposters?": ("targets that were drawn by themselves, with --engine gl", [{
                "targets": "string[]: by name", "pixels": "number: side of a square that holds them", "texels": "integer[]: columns and rows",
                "flux_error": "number: estimated, a share", "ms": "number: it took"}]),
            "flux_error?": "any: estimated: a share; with the reference engine three standard errors", "flux?": "vec3: of the image",
            "rays?": "integer: cast", "seconds?": "number: it took"}]),
    },
    "material": {
        "materials?": ("reports", [MATERIAL]), "presets?": "string[]: with --list: the library",
        "readings?": "integer: with --fit: lines of the table",
        "fits?": ("with --fit: the best first", [{"brdf": "string: model in words", "law": "string: the same, as it was called", "rms_decades": "number: of log10(BRDF/reading)",
                                                "max_decades": "number: largest", "rms": "number: 1/sr", "text": "string: pxn"}]),
    } | OPTIONAL(MATERIAL),
    "mli": {
        "sheets": ("of the file, or the preset; a pan file holds no recipes: what follows correlation_length is missing", [{
            "name": "string: of its node or mesh; the preset", "form": "string: flat, tube, cone, disc or box; all numbers are of the flat sheet", "seed": "integer: of its recipe",
            "width": "number: metres", "height": "number: metres", "cells": "number[]: along width and height", "heights": "number[]: lowest and highest, metres",
            "height_mean": "number: metres", "height_rms": "number: metres, about the mean", "slope_mean": "number[]: along x and y", "slope_covariance": "number[]: xx, xy, yy, at vertices",
            "facet_slope_covariance": "number[]: the same of triangles", "slope_rms": "number: both axes together", "slope_rms_axes": "number[]: along x and y",
            "correlation_length": "number[]: along x and y, metres", "material?": "string: that it is drawn in", "operations?": "string[]: of the recipe, in order",
            "grid?": "integer: cells across of the recipe's own grid", "facet_slope_rms?": "number: of triangles", "mean_normal?": "vec3: unit",
            "removed_slope_covariance?": "number[]: xx, xy, yy that coarser detail lost", "tilt_histogram?": "number[]: triangles by tilt, bins of half a degree",
            "slope_histogram?": ("triangles by slope", {
                "lowest": "number: lower end of the first bin", "bin": "number: width of a bin", "facets": "integer: how many",
                "x": "object: mean, deviation, counts of each bin, below, above", "y": "object: the same along y"}),
            "checksum?": "string: of the bits of the heights, 16 hexadecimal digits", "seconds?": "number: it took to make",
            "fit?": ("with --fit", {
                "fitted": ("sheets that the recipe was found with", {"first_seed": "integer: the others follow", "sheets": "integer: how many"}),
                "checked": ("others", {"first_seed": "integer: the others follow", "sheets": "integer: how many"}),
                "statistics": ("means over seeds; metres but for slopes", [{
                    "name": "string: slope_rms, correlation or height_rms", "asked": "number|null: by the options", "fitted": "number: over the sheets that it was found with",
                    "checked": "number: over the others", "standard_error": "number: of checked", "deviation": "number: of single sheets, one standard deviation"}]),
                "pxn": "string: the recipe as an element <mli>, after its <material> where that is of the library"})}]),
    },
    "diff": {
        "equal": "boolean: exit code 0; otherwise 1",
        "model": ("differences of what is drawn", [{"where": "string: place", "what": "string: both values"}]),
        "provenance": ("of what it was made from", [{"where": "string: place", "what": "string: both values"}]),
        "storage": ("of how it is stored", [{"where": "string: place", "what": "string: both values"}]),
    },
    "fmt": {"files": ("in the order of the command line", [{"file": "string: as typed", "changed": "boolean: it is, or with --check would be"}])},
    "upgrade": {"files": ("in the order of the command line", [{"file": "string: as typed", "upgraded": "boolean: false: was of level 1", "paths_changed": "integer: how many"}])},
    "expand": {"output": "string: the text", "nodes": "integer: how many", "shapes": "integer: how many", "images": "string[]: textures of the text",
               "pictures": "string[]: the same, as it was called"},
    "explain": OPTIONAL(CODE) | {"codes?": ("without a code: all", [CODE])},
    "help": {
        "commands": ("all, or the one that was named", [{
            "name": "string: render", "help": "string: one line",
            "options": ("arguments too", [{
                "names": "string[]: -o, --output", "help": "string: what it does", "value": "string|null: the name of its value; null: a flag",
                "choices": "string[]: all values there are; empty: others", "argument": "boolean: without a name on the command line", "required": "boolean: it is",
                "repeatable": "boolean: it is", "group": "string: heading of the help"}]),
            "examples": ("from a copy of examples/", [{"words": "string: command line", "what": "string: what it does"}])}]),
    },
    "version": {
        "name": "string: panwright", "version": "string: MAJOR.MINOR.PATCH", "commit": "string|null: of the checkout that was built, -dirty where it was changed",
        "compiler": "string: name and version", "build_type": "string: of CMake", "libraries": "object: version by name", "pan_format": "string: newest that is read and written",
        "pxn_levels": "integer[]: of the language", "features": "string[]: what this build can do", "reads": "string[]: extensions", "writes": "string[]: extensions",
    },
    "completion": {"shell": "string: bash, zsh or fish", "script": "string: its text"},
    "new": {"folder": "string: that was made", "files": "string[]: that were written"},
    "view": {
        "frames?": "integer: of the window",
        "ui_ms?": ("once the window is closed", {"median": "number: of the work for a frame, on the window's own thread", "p99": "number: 99 of 100 take no longer", "most": "number", "most_cpu": "number: of a processor, whatever else the machine does"}),
        "following?": ("once the window is closed", {"images": "integer: drawn while something moved", "ms": "number: that one took, a running mean", "scale": "number: its pixels, in parts of the exact image's, a side",
            "coarser": "number: its levels of detail are those of pixels so many times as wide", "rate": "number: of them, a second, while one follows the other"}),
        "first_image_ms?": "number: from the start to the first image on the screen; 0: there was none",
        "save_to_image_ms?": ("where a file was saved: from its time of modification to the image of it on the screen", {
            "count": "integer: of them", "median": "number", "most": "number",
            "last": ("the last one, each from the file's time", {"noticed": "number: the change was seen", "read": "number: the model was made", "shown": "number: its image was on the screen"})}),
        "memory?": ("of scripts", {"every": "integer: frames from one to the next", "mib": "number[]: of the process, resident"}),
        "exact?": "integer: exact images drawn", "readings?": "integer: of the models",
        "renderer?": "string: by the driver; of what draws images", "render?": "string: the command line that makes the last image",
    },
}
