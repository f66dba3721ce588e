"""What every command prints with --json: the one description, of which generate_json.py makes schemas and the page.

A field is NAME: "TYPE: what it is", with NAME? where it may be missing even after success. Types: number, integer, string,
boolean, object (of any members), vec3, any; T[] a list of T; T|null. A tuple (words, {fields}) is an object, (words, [{fields}])
a list of objects. Other fields are there whenever the exit code is 0.
"""

DIAGNOSTIC = {
    "code": "string: as E1101; see `panwright explain`",
    "severity": "string: error, warning or note",
    "message": "string: the problem, the value found and the values accepted",
    "file?": "string: the file concerned",
    "line?": "integer: from 1",
    "column?": "integer: from 1, in characters",
    "end_line?": "integer: end of the marked text",
    "end_column?": "integer: end of the marked text",
    "object?": "string: path in the model, as group[2]/mesh",
    "hint?": "string: suggestion, as: did you mean …",
    "included_from?": ("the includes that lead to the file, innermost first", [{"file": "string: the file", "line": "integer: of the include"}]),
}

COMMON = {
    "schema": "integer: version of the schema, the last number of schema_id",
    "schema_id": "string: name of the schema, panwright/COMMAND/VERSION",
    "command": "string: the command; `usage` where none was recognised",
    "exit_code": "integer: docs/conventions.md 18",
    "errors": "integer: number of them",
    "warnings": "integer: number of them",
    "notes": "integer: number of them",
    "hidden": "integer: number of diagnostics over the limit, not listed",
    "diagnostics": ("diagnostics, by file, from top to bottom", [DIAGNOSTIC]),
    "timings_ms?": "object: with --timings: milliseconds of each step by its name",
    "written?": "string[]: files written",
}

EXTREME = {"column?": "integer", "row?": "integer", "posts?": "integer: that have this height", "latitude?": "number: degrees", "longitude?": "number: degrees east"}

MATERIAL = {
    "name": "string: as in its file",
    "brdf": "string: its BRDF models in words",
    "back": "string|null: the material of its back; null: the same",
    "directional_albedo": ("by cosine", [{"mu": "number: cosine of the angle to the normal", "rgb": "vec3: mean over the azimuth, at 650, 550, 450 nm",
                                        "least": "vec3: least over the azimuth", "largest": "vec3: largest over the azimuth"}]),
    "hemispherical_albedo": "vec3: at 650, 550, 450 nm",
    "largest_albedo": ("the largest directional albedo", {"albedo": "number: at most 1 where energy is conserved", "mu": "number: its cosine"}),
    "reciprocity_residual": "number: largest, relative",
    "fit_error": "number: largest approximation error; 0 where nothing is approximated",
    "f32_error": ("of single precision, relative", {"max": "number: largest", "rms": "number: RMS"}),
    "ns_per_evaluation": ("nanoseconds, one core", {"f64": "number: in double precision", "f32": "number: in single precision"}),
    "solar_absorptance": ("0.3 to 2.5 µm", {"computed": "number|null: from n and k", "published": "number|null: by the material's source"}),
    "provenance": ("provenance of its numbers", {"source": "string: publication", "published": "string: values used as published",
                                                   "fitted": "string: values that were fitted", "indicative": "string: values that are guesses"}),
}

STORAGE = ("of positions, normals and indices: --compress", {
    "form": "string: none, lossless, lossy:16 …", "bytes": "integer: of their streams; 0 of none and lossless",
    "position_error": "number: metres in the frame of a mesh, largest displacement of a vertex", "normal_error": "number: degrees, largest rotation of a normal",
    "meshes_with_more_bits": "integer: meshes stored with more bits, for their tolerance"})

IMAGES = {
    "gl?": ("with --engine gl, but for terrain alone", {"renderer": "string: by the driver", "version": "string: by the driver", "hardware": "boolean: whether it is hardware"}),
    "images": ("written", [{
        "output": "string: the file", "width": "integer: pixels", "height": "integer: pixels", "unit": "string: of radiance: W/(m^2 sr) or 1/sr",
        "exposure_s?": "number: exposure time of a detector, seconds",
        "bits?": "integer: of its numbers",
        "saturated?": "integer: number of pixels at the full well or the largest number",
        "moments?": "integer: number of moments whose mean is the image, of an exposure over time",
        "samples?": "number: mean per pixel; of the reference engine the total", "ground_rays?": "number: mean per pixel, of terrain; with --engine gl", "pixel_error?": "number: estimated, RMS by RMS",
        "light_between?": ("that surfaces send one another, with --indirect on or auto", {
            "drawn": "boolean: false: it changes the image by less than is asked", "flux": "number: estimate of its share of the flux",
            "mirrors": "boolean: targets have mirrors or smooth coats, which show others by rays",
            "rms": "number: of its RMS, in parts of the radiance's", "surfels": "integer: of all targets"}),
        "shadow_edge?": "number: 99th percentile of the error of shadow edges, pixels; with --engine gl",
        "penumbra?": "number: largest possible width of a penumbra, pixels; with --engine gl, shadows of the Sun's disc",
        "sun_points?": "integer: least number of points of the Sun's disc; 1: hard shadows",
        "lamps?": "integer: number of lights beside the Sun on the target that has most; with --engine gl",
        "lamps_without_shadow?": "integer: of these, those too weak to cast shadows",
        "lamps_left_out?": "integer: weakest ones, beyond 64",
        "lamp_penumbra?": "number: largest possible width of a lamp's penumbra, pixels",
        "lamp_points?": "integer: most points of a lamp's disc; 1: hard shadows",
        "programs?": "integer: number of shader programs built for this image; with --engine gl",
        "programs_ms?": "number: time to build them",
        "imposters?": ("targets drawn separately, with --engine gl", [{
            "targets": "string[]: by name", "pixels": "number: side of a square that holds them", "texels": "integer[]: columns and rows",
            "flux_error": "number: estimated, a share", "ms": "number: time"}]),
        "flux_error?": "any: estimated: a share; with the reference engine three standard errors", "flux?": "vec3: of the image",
        "rays?": "integer: cast", "seconds?": "number: time"}]),
}

REUSED = {"reused": "integer: number from the cache", "made": "integer: number computed"}
CACHE = ("use of the cache, if there is one", {
    "meshes": ("triangles for exact shapes", REUSED), "levels": ("levels of detail of meshes", REUSED), "simplified": ("meshes made coarser for the budget", REUSED),
    "foil": ("sheets and blankets", REUSED), "cleaned": ("meshes of CAD files", REUSED)})

OPTIONAL = lambda fields: {(name if name.endswith("?") else name + "?"): what for name, what in fields.items()}

TOLERANCE = {"tolerance": "number|null: required, metres", "ratio": "number|null: error over tolerance", "reason": "string: the term that decided it"}

BUDGET = {
    "tolerance": "number|null: metres", "nearest": "number|null: metres", "ifov": "number|null: radians", "pixels": "number|null: of silhouettes",
    "flux": "number|null: relative", "centroid": "number|null: pixels", "smallest_tolerance": "number|null: metres, the finest in the model",
    "gives": ("tolerances of the terms, metres", {"pixels": "number|null: of silhouettes", "centroid": "number|null: of photocentres"}),
    "meshes_decided_by": "object: number of meshes by the term that decided their tolerance",
}

JOINTS = ("by node; values in radians, metres and factors", [{
    "name": "string: its own", "type": "string: fixed, revolute, continuous, prismatic, ball, general or scale", "node": "integer: index", "path": "string: of the node",
    "axis": "vec3: unit, of the node", "lower": "number[]|null: limits of each value", "upper": "number[]|null: limits of each value", "initial": "number[]: values",
    "value": "number[]: current values", "mimic": "string|null: the joint that it follows", "multiplier?": "number: with mimic", "offset?": "number: with mimic",
    "pointing": "vec3|null: direction that it aims, unit, of the node", "gimbal": "string|null: the joint that aims with it", "point_at": "string: sun or empty"}])
CODE = {"code": "string: E1101", "severity": "string: error, warning or note", "title": "string: the problem as a noun phrase",
        "explanation": "string: meaning and remedy", "example": "string: input that causes it", "cure": "string: remedy"}

FITTED = ("of a model with a budget: terms and results", {
    "asked": ("its terms", {
        "tolerance": "number|null: metres", "nearest": "number|null: metres", "ifov": "number|null: radians", "pixels": "number|null: of silhouettes",
        "flux": "number|null: relative", "centroid": "number|null: pixels", "approach": "string|null: frame", "corridor": "number|null: radians"}),
    "achieved": ("bounds", {
        "error": "number: metres, in a mesh's own frame", "pixels": "number|null: the largest error of a part, at its nearest",
        "flux_left_out": "number: of the model's", "flux_simplified": "number: of the model's, error of simplified meshes", "flux_shapes": "number: of the model's, error of shapes", "centroid_left_out": "number|null: pixels"}),
    "pieces": "integer: number of parts of the model", "pieces_left_out": "integer: number of parts left out", "triangles_left_out": "integer: of meshes, instances counted",
    "seconds": "number: time of removal and simplification",
    "parts": ("meshes of the file, from the most triangles", [{
        "name": "string: of the first node", "mesh": "string: in the file", "instances": "integer: of it", "triangles": "integer: instances counted",
        "bytes": "integer: of vertices and indices", "nearest": "number|null: metres from the camera", "tolerance": "number|null: metres in the world, null: as given",
        "reason": "string: the term that decided", "error": "number: metres in the world, bound", "seconds": "number: of one core"}]),
    "left_out": ("from the largest area", [{"name": "string: of the node", "pieces": "integer: parts", "triangles": "integer: of meshes", "area": "number: m^2, sum of their largest projected areas"}]),
    "simplified": ("from the most triangles saved", [{"name": "string: of the first node", "before": "integer: triangles", "after": "integer: triangles",
        "error": "number: metres in its own frame, bound", "flux": "number: diffuse, relative", "normals": "number: radians, RMS", "seconds": "number: of one core"}]),
})

COMMANDS = {
    "compile": {
        "output": "string: the pan file", "bytes": "integer: its size", "triangles": "integer: as drawn, instances counted",
        "unique_triangles": "integer: as stored", "unique_meshes": "integer: as stored", "instances": "integer: of meshes",
        "worst_error": "number: metres, largest distance between mesh and shape; of terrain between stored heights and their source",
        "tiles?": "integer: of terrain", "budget?": FITTED,
        "storage": STORAGE,
        "cache?": CACHE,
    },
    "import": {
        "storage?": STORAGE,
        "format?": "string: without -o: the format of the file", "nodes?": "integer: without -o", "instances?": "integer: without -o",
        "mesh_triangles?": "integer: without -o, as stored in the file", "textures?": "integer: without -o", "joints?": "integer: without -o",
        "size?": "vec3: without -o: extent, metres",
        "materials?": ("without -o: guessed preset of each material", [{
            "name": "string: in the file", "preset": "string: of the library", "reason": "string: of the guess", "triangles": "integer: of meshes with it", "area": "number: of these, m^2", "lost": "string[]: properties that are ignored"}]),
        "output?": "string: the file of -o", "bytes?": "integer: of a pan file", "triangles?": "integer: as drawn", "unique_triangles?": "integer: as stored",
        "budget?": FITTED,
        "removed?": ("hidden parts", {
            "triangles_before": "integer: before", "triangles_after": "integer: after", "instances_before": "integer: before", "instances_after": "integer: after",
            "rays": "integer: cast", "open_share_95": "number: 95 % bound of the visible share of a removed triangle", "seconds": "number: time",
            "cached": "boolean: found by an earlier run"}),
        "cache?": CACHE,
    },
    "export": {"output": "string: the glTF file", "bytes": "integer: its size"},
    "check": {
        "files": ("in the order of the command line", [{
            "file": "string: as typed", "ok": "boolean: no errors", "errors": "integer: number of them", "warnings": "integer: number of them",
            "format?": "string: of a pan file, as 1.1", "compressed?": "boolean: of a pan file"}]),
    },
    "info": {
        "kernel?": "boolean: true for a SPICE kernel, which has `file`, `segments` and `variables` alone",
        "segments?": ("of a SPICE kernel", [{"kind": "string: as SPK type 2", "name": "string: its own", "file": "string: its kernel", "id": "integer: of a body, instrument or frame",
                                             "of": "string: its name", "relative": "integer: its centre or reference frame", "relative_to": "string: its name",
                                             "begin": "string: TDB, or ticks of a clock", "end": "string: the same", "read": "boolean: whether its type is read", "frame?": "string: of an SPK"}]),
        "variables?": "string[]: names in a text kernel",
        "file": "string: as typed", "bytes": "integer: of the pan file (compiled in memory for other files)", "format": "string: of the pan file", "compressed": "boolean: whether it is compressed", "storage?": "string: of meshes stored as streams: form and largest error",
        "build_id": "string: 32 hexadecimal digits; equal for equal models and inputs", "version": "string: of the program that made it",
        "options": "string: options that it was made with", "triangles": "integer: as drawn", "vertices": "integer: as drawn", "unique_triangles": "integer: as stored",
        "unique_vertices": "integer: as stored", "error": "number: metres, largest distance between mesh and shape",
        "bounds": ("metres, world axes", {"min": "vec3|null: lowest corner", "max": "vec3|null: highest corner"}),
        "nodes": ("parents first", [{"name": "string: its own", "parent": "integer|null: index", "translation": "number[]: x y z, metres",
                                     "rotation": "number[]: as stored", "scale": "number[]: x y z"}]),
        "joints": JOINTS,
        "instances": ("of meshes", [{"node": "integer: index", "mesh": "integer: index", "material": "integer: index", "texture": "integer|null: index",
                                     "back?": "integer: index of the material of its back", "source?": "string: file:line:column"}]),
        "budget": "object|null: the model's budget, by term and as `gives`",
        "materials": "object[]: name, models, parameters as schemas/material.toml names them, maps",
        "meshes": ("as stored", [{"name": "string: its own", "triangles": "integer: number of them", "vertices": "integer: number of them", "error": "number: metres, own frame",
                                  "budget": "object|null: tolerance, ratio of error to it, reason",
                                  "closed": "boolean: no boundary"}]),
        "textures": ("as stored", [{"name": "string: its file", "width": "integer: pixels", "height": "integer: pixels"}]),
        "frames": ("of the model", [{"name": "string: its own", "node": "integer: index", "origin": "vec3: metres, world axes", "right": "vec3: unit", "forward": "vec3: unit"}]),
        "inputs": ("input files", [{"path": "string: from the model's folder", "bytes": "integer: size", "xxh3": "string: hash, 32 digits"}]),
        "keypoints": ("of the model", [{"name": "string: its own", "node": "integer: index", "position": "vec3: metres, of the node", "world": "vec3: metres, world axes"}]),
        "lamps": ("of the model", [{"name": "string: its own", "node": "integer: index", "kind": "string: spot, point or disc", "flags": "integer: 1: off", "position": "number[]: metres, of the node",
                                    "axis": "number[]: unit", "intensity": "number[]: W/sr per band", "half_angle": "number: radians", "exponent": "number: of the cosine", "radius": "number: metres"}]),
        "scene": ("settings of views", [{"name": "string: of the setting", "value": "string: as an option takes it"}]),
        "decals": "object[]: name, instance, texture, origin, rotation, width, height, depth",
        "sheets": ("of foil", [{"mesh": "integer: index", "form": "string: flat, tube, cone, disc, box or wrap", "seed": "integer: of its recipe", "width": "number: metres", "height": "number: metres",
                                "cells": "number[]: along width and height", "heights": "number[]: lowest and highest, metres", "height_mean": "number: metres", "height_rms": "number: metres",
                                "slope_mean": "number[]: along x and y", "slope_covariance": "number[]: xx, xy, yy", "facet_slope_covariance": "number[]: the same of triangles",
                                "slope_rms": "number: both axes together", "correlation_length": "number[]: along x and y, metres"}]),
        "levels": ("of detail, by instance", [{"instance": "integer: index", "mesh": "integer: index", "material": "integer: index", "detail": "number: smallest pixel footprint at which it is drawn, metres",
                                "error": "number: metres", "triangles": "integer: of the mesh"}]),
        "sections": ("of the pan file", [{"kind": "integer: number", "name": "string: of the kind", "read": "boolean: whether this program reads it", "count": "integer: elements",
                                          "element_bytes": "integer: of one", "bytes": "integer: raw", "stored_bytes": "integer: in the file", "compressed": "boolean: whether it is compressed"}]),
    },
    "joints": {
        "file": "string: as typed", "joints": JOINTS,
        "nodes": ("parents first", [{"name": "string: its path", "world_pose": "number[][]: world_from_node, four rows of four"}]),
        "sweep?": ("with --sweep", [{"joint": "string: its name", "from": "number: radians, metres or a factor", "to": "number: the same",
                                     "positions": "integer: number of them", "min": "vec3: lowest corner of the moving parts, metres", "max": "vec3: highest corner",
                                     "collisions": "object[]: a and b, paths of colliding nodes; first and last value; positions"}]),
    },
    "render": IMAGES,
    "run": IMAGES | {
        "measured?": ("by instruments, a frame after the other", [{
            "outputs": "string[]: the files", "pulses?": "integer: of a LiDAR", "points?": "integer: of its cloud",
            "ranges?": "integer: columns of a RADAR's histogram", "speeds?": "integer: its rows"}])},
    "scenario": {
        "epoch?": "string: of time 0, where the scenario has dates", "time_system?": "string: of the epoch: UTC, TAI, TT, TDB or GPS",
        "channels": "string[]: members of frames that sources give",
        "frames": ("in order", [{
            "number": "integer: from 0", "time?": "number: seconds after the epoch", "epoch?": "string: of the frame", "name?": "string: its own",
            "seed?": "integer: its own", "camera?": "vec3: position, metres", "quat?": "number[]: w x y z, world_from_camera",
            "fov?": "number: full horizontal angle, radians", "intrinsics?": "number[]: fx fy, and cx cy where given, pixels",
            "poses?": "object: of targets by name: x y z qw qx qy qz, world_from_model", "joints?": "object: values by TARGET/JOINT: radians, metres, factors",
            "sun?": "vec3: direction, unit", "sun_distance?": "number: AU"}]),
    },
    "camera": {
        "size": "integer[]: pixels", "width_m?": "number: across the image of an orthographic camera",
        "pixel_rad?": "number: on the axis", "range_of_1m?": "number: metres at which 1 m is one pixel",
        "field_of_view_deg?": "number[]: full angles across the image",
        "focal_length_mm?": "number", "aperture_mm?": "number", "f_number?": "number",
        "airy_px?": "number: wavelength · f-number in pixels, at 550 nm",
        "mtf_nyquist?": ("of the camera's parts that have one, at 0.5 cycles per pixel", {
            "pixel": "number", "diffraction?": "number", "gaussian?": "number: aberrations, jitter, diffusion", "defocus?": "number", "system": "number"}),
        "encircled_energy?": ("without the pixel", [{"radius_px": "number", "share": "number"}]),
        "focus?": ("of optics with one: distances whose discs are at most a pixel", {
            "distance_m": "number: that is sharp", "infinity_px": "number: diameter of the disc of what is far", "nearest_m": "number",
            "farthest_m?": "number: none where it is infinity"}),
        "full_well_e?": "number: electrons", "saturation_e?": "number: electrons at which the well or the numbers end",
        "dn_per_e?": "number: gain", "dark_e_per_s?": "number: at its temperature", "dynamic_range_db?": "number",
        "noise?": ("standard deviations of a pixel, electrons", [{
            "signal_e": "number", "shot": "number", "prnu": "number", "dark": "number", "dsnu": "number", "read": "number",
            "rounding": "number", "total": "number", "snr": "number"}]),
        "exposure?": ("of a Lambert plate in full sunlight at 1 AU", {
            "albedo": "number", "e_per_s": "number", "seconds": "number: to 80 % of saturation"})},
    "stars": {"stars": ("from the brightest", [{
        "hip?": "integer: number in the Hipparcos catalogue", "name?": "string", "v": "number: magnitude V", "b_v?": "number: B - V, magnitudes",
        "pixel": "number[]: column and row of the centre; pixel (i, j) covers [i, i+1) x [j, j+1)", "direction": "vec3: unit, world axes, apparent",
        "irradiance": "vec3: W/m2 in bands of 100 nm about 650, 550, 450 nm"}])},
    "lookup": {
        "surfaces": ("one for each pixel, ray, elevation and nearest point, in this order", [{
            "kind": "string: pixel, ray, elevation or nearest", "asked": "number[]: the question", "found": "boolean: whether there is a surface",
            "distance?": "number: metres from the ray's origin, or the point; of elevations 0", "position?": "vec3: metres, world axes",
            "in_model?": "vec3: the same in the target's axes", "facet?": "vec3: normal of the triangle, unit, world axes",
            "normal?": "vec3: interpolated", "target?": "string", "node?": "string: its path", "material?": "string",
            "ids?": "integer[]: of target, node, material and instance: index + 1"}]),
        "sights": ("lines of sight", [{"asked": "number[]: two points", "open": "boolean: nothing stands between them"}]),
        "keypoints?": ("with --keypoints", [{
            "target": "string", "name": "string", "position": "vec3: metres, in the target's axes", "pixel?": "number[]: column and row",
            "truncated": "boolean: outside the image", "occluded": "boolean: hidden from the camera", "lit": "boolean: by the Sun"}])},
    "lidar": {
        "lidar": "string: its name", "pulses": "integer", "points": "integer", "no_echo": "integer: pulses", "out_of_gate": "integer: pulses",
        "dropped": "integer: pulses", "false_alarms": "integer: points of no surface", "pulse_energy_j": "number: within the eye-safe limit",
        "mean_power_w?": "number: of a scan", "range?": "number[]: nearest and farthest point, metres"},
    "serve": {
        "requests?": "any: with --coverage a list of the protocol's requests: number, name, version, support (full, part, none) and note; with --replay their number",
        "sessions?": "integer: with --replay: number of them", "different?": "integer: with --replay: replies that differ",
        "first_different?": "string: with --replay: place of the first of them; empty: none"},
    "dem": {
        "kind": "string: raster, shape or terrain", "format": "string: PDS3, PDS4, ISIS cube, GeoTIFF, ENVI, GDAL (driver); of a shape plates (.tab), plates (.plt), OBJ, ICQ, DSK type 2; of terrain pan",
        "files": "string[]: read, the label first", "unit": "string: of the file: m or km, or metres of a number; empty: of plain numbers", "unit_stated": "boolean: the file states it",
        "min": "number|null: lowest height, metres over the sphere; of a shape the least radius; null: all posts are void", "max": "number|null: highest",
        "width?": "integer: columns of a raster", "height?": "integer: rows", "bands?": "integer", "band?": "integer: the one read, from 1",
        "sample?": "string: type of its numbers", "values?": "string: height, radius or plain", "scale?": "number: of stored numbers", "offset?": "number: added after the scale",
        "target?": "string: body; of a DSK its NAIF id", "frame?": "string: coordinate system; of a DSK its NAIF id", "projection?": "string: as the file names it",
        "placed?": "boolean: posts have a latitude and longitude", "pixel_m?": "number[]: metres on the map, along columns and rows",
        "corner_m?": "number[]: outer corner of the first pixel on the map, x and y", "radius_m?": "number: of the sphere, at the equator", "polar_radius_m?": "number",
        "positive_longitude?": "string: east or west, in the file; here longitudes count to the east", "longitude_domain?": "integer: 360: [0, 360); 180: [-180, 180)",
        "center_longitude_deg?": "number: of the projection",
        "corners_deg?": ("latitude and longitude of outer corners and centre", {
            "upper_left": "number[]", "upper_right": "number[]", "lower_left": "number[]", "lower_right": "number[]", "center": "number[]"}),
        "lowest?": ("its post", EXTREME), "highest?": ("its post", EXTREME),
        "mean?": "number|null: metres", "deviation?": "number|null: standard, metres", "valid?": "integer: posts with a height", "voids?": "integer: posts without",
        "voids_by_kind?": "object: number by kind: missing, null, low_instrument, low_representation, high_instrument, high_representation, out_of_range, not_finite, undeclared",
        "missing_constant?": "number: stored number that stands for none",
        "slopes?": ("along rows and columns, on the ground", [{
            "posts": "integer: apart", "metres": "number: apart, at the middle", "rms_deg": "number: of the RMS tangent", "median_deg": "number: of absolute slopes", "pairs": "integer"}]),
        "slope_rows?": "integer: slopes are of each n-th row", "exaggeration?": "number: factor of heights in the hillshade",
        "vertices?": "integer: of a shape", "plates?": "integer", "size_m?": "vec3: of its bounds", "area_m2?": "number", "volume_m3?": "number: negative where plates face inwards",
        "centroid_m?": "vec3: of the volume", "open_edges?": "integer: of one plate, or more than two", "flat_plates?": "integer: without an area",
        "bytes?": "integer: of a pan file with terrain",
        "charts?": ("of terrain; where they overlap, the first with a height gives it", [{
            "target": "string: body; may be empty", "frame": "string: coordinate system; may be empty", "projection": "string: cylindrical, polar stereographic or plane",
            "width": "integer: posts along a row, the closing one of a map round the body included", "height": "integer: rows", "pixel_m": "number[]: metres on the map, along columns and rows",
            "radius_m": "number: of the sphere; 0 of a plane", "levels": "integer", "tiles": "integer: of all levels", "step_m": "number: between stored heights; 0: floats",
            "error_m": "number: largest distance of a stored height from its source", "min": "number: lowest height, metres over the sphere", "max": "number: highest",
            "void_tiles": "integer: without any height"}]),
        "albedo?": ("maps of terrain; the first with a value gives it", [{
            "width": "integer: pixels", "height": "integer", "bands": "integer: 1, or red, green and blue", "pixel_m": "number[]: metres on the map, along columns and rows",
            "mean": "number: of the factors of the material's colour, by area", "largest": "number: of the factors"}]),
        "points?": ("with --at, in its order", [{
            "latitude": "number: degrees; of a plane y, metres", "longitude": "number: degrees; of a plane x", "height?": "number: metres over the sphere; absent: no ground",
            "slope_deg?": "number: between normal and vertical", "normal?": "vec3: of the triangle, unit, body-fixed", "position?": "vec3: metres, body-fixed", "upright?": "number[]: w x y z, attitude of what stands upright there, x east", "sun?": "vec3: unit, to a Sun of --light", "chart?": "integer"}]),
        "sights?": ("with --sight, in its order", [{
            "asked": "number[]: two places, each with metres above the ground", "open?": "boolean: no ground stands between; absent: a place has no ground",
            "distance?": "number: metres between the two", "range?": "number: to the ground that blocks, metres", "latitude?": "number: of it, degrees; of a plane y",
            "longitude?": "number", "height?": "number: of it, metres over the sphere"}]),
        "ranges?": ("with --range, in its order", [{
            "asked": "number[]: place, metres above the ground, azimuth, elevation", "range?": "number: metres; absent: no ground is met", "latitude?": "number: of the ground, degrees; of a plane y",
            "longitude?": "number", "height?": "number: of it, metres over the sphere"}])},
    "radar": {
        "radar": "string: its name",
        "ranges": ("columns", {"count": "integer", "first_m": "number: metres, of its centre", "step_m": "number: metres"}),
        "speeds": ("rows", {"count": "integer", "first_m_s": "number: m/s, of its centre", "step_m_s": "number: m/s"}),
        "gain": "number: largest of the antenna", "echo_power_w": "number: watts of all echoes", "outside": "number: share of it outside of the histogram",
        "noise_w": "number: watts, mean of a cell", "response_sum": "number: sum over the cells of an echo whose largest cell is 1",
        "rays": "integer", "hits": "integer: rays that met a surface", "ray_spacing_rad": "number: radians between rays",
        "targets": ("without noise and antenna pattern", [{"name": "string", "cross_section_m2": "number: m2",
            "range_m?": "number: metres, mean by power", "speed_m_s?": "number: m/s, the same"}]),
        "altitude_m?": "number: metres, of an altimeter that has found a surface"},
    "labels": {"output": "string: the folder", "formats": "string[]: those written", "frames": "integer: number of them"},
    "dataset": {
        "action?": "string: plan, run, check or pack", "frames?": "integer: rows of the table",
        "coverage?": "object: of plan: range, phase and pixels, each with unit, least, median, most, edges and counts of bins",
        "images?": "object[]: of run, as of the command `run`", "kept?": "integer: frames that were whole", "rendered?": "integer: frames that were made",
        "whole?": "integer: frames whose files have their hashes", "archives?": "string[]: of pack"},
    "material": {
        "materials?": ("reports", [MATERIAL]), "presets?": "string[]: with --list: the library",
        "readings?": "integer: with --fit: lines of the table",
        "fits?": ("with --fit: the best first", [{"brdf": "string: model in words", "rms_decades": "number: of log10(BRDF/reading)",
                                                "max_decades": "number: largest", "rms": "number: 1/sr", "text": "string: pxn"}]),
    } | OPTIONAL(MATERIAL),
    "mli": {
        "sheets": ("of the file, or the preset; of a pan file only the fields up to correlation_length", [{
            "name": "string: of its node or mesh; the preset", "form": "string: flat, tube, cone, disc or box; all numbers are of the flat sheet", "seed": "integer: of its recipe",
            "width": "number: metres", "height": "number: metres", "cells": "number[]: along width and height", "heights": "number[]: lowest and highest, metres",
            "height_mean": "number: metres", "height_rms": "number: metres, about the mean", "slope_mean": "number[]: along x and y", "slope_covariance": "number[]: xx, xy, yy, at vertices",
            "facet_slope_covariance": "number[]: the same of triangles", "slope_rms": "number: both axes together", "slope_rms_axes": "number[]: along x and y",
            "correlation_length": "number[]: along x and y, metres", "material?": "string: material of the image", "operations?": "string[]: of the recipe, in order",
            "grid?": "integer: cells across of the recipe's own grid", "facet_slope_rms?": "number: of triangles", "mean_normal?": "vec3: unit",
            "removed_slope_covariance?": "number[]: xx, xy, yy removed by coarser detail", "tilt_histogram?": "number[]: triangles by tilt, bins of half a degree",
            "slope_histogram?": ("triangles by slope", {
                "lowest": "number: lower end of the first bin", "bin": "number: width of a bin", "facets": "integer: number of them",
                "x": "object: mean, deviation, counts of each bin, below, above", "y": "object: the same along y"}),
            "checksum?": "string: of the bits of the heights, 16 hexadecimal digits", "seconds?": "number: time to make it",
            "fit?": ("with --fit", {
                "fitted": ("sheets of the fit", {"first_seed": "integer: first of consecutive seeds", "sheets": "integer: number of them"}),
                "checked": ("others", {"first_seed": "integer: first of consecutive seeds", "sheets": "integer: number of them"}),
                "statistics": ("means over seeds; metres but for slopes", [{
                    "name": "string: slope_rms, correlation or height_rms", "asked": "number|null: target of the options", "fitted": "number: mean of the fitted sheets",
                    "checked": "number: mean of the others", "standard_error": "number: of checked", "deviation": "number: of single sheets, one standard deviation"}]),
                "pxn": "string: the recipe as an element <mli>, after a <material> of the library if it has one"})}]),
    },
    "diff": {
        "equal": "boolean: exit code 0; otherwise 1",
        "model?": ("differences of the model", [{"where": "string: place", "what": "string: both values"}]),
        "provenance?": ("of the inputs", [{"where": "string: place", "what": "string: both values"}]),
        "storage?": ("of the storage", [{"where": "string: place", "what": "string: both values"}]),
        "geometry?": ("with --geometry, instead of the others", {
            "triangles_a": "integer: triangles of a", "triangles_b": "integer: triangles of b", "tolerance": "number: metres", "largest_distance": "number: metres, of corresponding corners",
            "parts": ("with triangles that the other model does not have at their place", [{
                "where": "string: mesh and node", "in": "string: a or b", "unmatched": "integer: triangles without a counterpart", "triangles": "integer: triangles of the part"}])}),
    },
    "fmt": {"files": ("in the order of the command line", [{"file": "string: as typed", "changed": "boolean: whether it is changed, or with --check would be"}])},
    "upgrade": {"files": ("in the order of the command line", [{"file": "string: as typed", "upgraded": "boolean: false: already of level 1", "paths_changed": "integer: number of them"}])},
    "expand": {"output": "string: the text", "nodes": "integer: number of them", "shapes": "integer: number of them", "images": "string[]: textures of the text"},
    "explain": OPTIONAL(CODE) | {"codes?": ("without a code: all", [CODE])},
    "help": {
        "commands": ("all, or the named one", [{
            "name": "string: render", "help": "string: one line",
            "options": ("arguments too", [{
                "names": "string[]: -o, --output", "help": "string: description", "value": "string|null: name of its value; null: a flag",
                "choices": "string[]: accepted values; empty: any", "argument": "boolean: whether it is positional", "required": "boolean: whether it is required",
                "repeatable": "boolean: whether it is repeatable", "group": "string: heading of the help"}]),
            "examples": ("from a copy of examples/", [{"words": "string: command line", "what": "string: description"}])}]),
    },
    "version": {
        "name": "string: panwright", "version": "string: MAJOR.MINOR.PATCH", "commit": "string|null: of the checkout, with -dirty if it was changed",
        "compiler": "string: name and version", "build_type": "string: of CMake", "libraries": "object: version by name", "pan_format": "string: newest version read and written",
        "pxn_levels": "integer[]: of the language", "features": "string[]: features of this build", "reads": "string[]: extensions", "writes": "string[]: extensions",
    },
    "completion": {"shell": "string: bash, zsh or fish", "script": "string: its text"},
    "new": {"folder": "string: the new folder", "files": "string[]: written"},
    "view": {
        "frames?": "integer: of the window",
        "ui_ms?": ("once the window is closed", {"median": "number: work per frame on the window's thread", "p99": "number: 99th percentile", "most": "number", "most_cpu": "number: processor time"}),
        "following?": ("once the window is closed", {"images": "integer: drawn during motion", "ms": "number: time per image, a running mean", "scale": "number: resolution relative to the exact image, per side",
            "coarser": "number: factor of the pixel footprint that selects levels of detail", "rate": "number: images per second in continuous motion"}),
        "first_image_ms?": "number: from the start to the first image on the screen; 0: none",
        "save_to_image_ms?": ("after a file was saved: from its time of modification to its image on the screen", {
            "count": "integer: of them", "median": "number", "most": "number",
            "last": ("the last one, from the file's time", {"noticed": "number: to the detection of the change", "read": "number: to the new model", "shown": "number: to its image on the screen"})}),
        "memory?": ("of scripts", {"every": "integer: interval in frames", "mib": "number[]: resident memory of the process"}),
        "exact?": "integer: exact images drawn", "readings?": "integer: of the models",
        "renderer?": "string: by the driver, for the images", "render?": "string: command line of the last image",
    },
}

# A member that is true in a result of another kind, which has none of the members without `?`.
OTHER = {"info": "kernel"}
