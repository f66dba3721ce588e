#!/usr/bin/env python3
"""Holds what every command prints with --json against its schema.

json_output_test.py PANWRIGHT SOURCE_DIR [--no-gl]

The validator knows what the schemas use, and refuses a word that it does not know. Members that no schema describes are
errors too, but for commands whose results are tables of another schema.
"""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

PROGRAM, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
GL = "--no-gl" not in sys.argv[3:]
KNOWN = {"$schema", "$id", "title", "description", "type", "properties", "required", "items", "const", "if", "then", "minItems", "maxItems"}
TYPES = {
    "object": dict, "array": list, "string": str, "boolean": bool, "null": type(None),
    "integer": int, "number": (int, float),
}


def is_type(value, name):
    if isinstance(value, bool):
        return name == "boolean"
    return isinstance(value, TYPES[name])


def problems(value, schema, where, described):
    unknown = set(schema) - KNOWN
    if unknown:
        yield f"{where}: the schema uses {unknown}, which the test does not know"
    if "const" in schema and value != schema["const"]:
        yield f"{where}: is {value!r}, expected {schema['const']!r}"
    names = schema.get("type", [])
    names = [names] if isinstance(names, str) else names
    if names and not any(is_type(value, name) for name in names):
        yield f"{where}: {json.dumps(value)[:60]} is not of type {names}"
        return
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        for name in schema.get("required", []):
            if name not in value:
                yield f"{where}: {name} is missing"
        for name, member in value.items():
            if name in properties:
                yield from problems(member, properties[name], f"{where}/{name}", described)
            elif described and properties:
                yield f"{where}: no schema describes {name}"
        if "if" in schema and not list(problems(value, schema["if"], where, False)):
            yield from problems(value, schema["then"], where, False)
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            yield f"{where}: has {len(value)} elements"
        for i, item in enumerate(value):
            yield from problems(item, schema.get("items", {}), f"{where}[{i}]", described)


LINES = [
    "joints servicer/servicer.pxn --joint arm/elbow=90 --sweep-joint wing_left/fold --steps 5",
    "compile cubesat/cubesat.pxn -o c.pan --timings", "compile none.pxn", "compile wrong.pxn -o w.pan",
    "import cad/relay.wrl --units mm", "import cad/relay.wrl --units mm -o r.pan", "import cad/relay.wrl --units mm -o cad/r.pxn",
    "export paper/figure8.pxn -o f.glb", "check cubesat/cubesat.pxn c.pan wrong.pxn", "info c.pan", "info client/client.pxn", "info none.pan", "info ephemerides/client.xsp",
    "material copper", "material mli_gold_kapton white_z93", "material --list", "material --fit table.txt", "material golld",
    "mli crinkled", "mli quilted --cells 40 --fit slope_rms=0.1", "mli blankets/blankets.pxn", "mli crinkld",
    "diff paper/figure8.pxn paper/figure5a.pxn", "diff c.pan c.pan", "fmt --check cubesat/cubesat.pxn wrong.pxn", "upgrade paper/figure7.pxn -o u.pxn",
    "expand client/client.pxn -o e.pxn", "explain E1101", "explain", "explain E9999", "scenario rendezvous/approach.toml --frames 0..2", "scenario none.toml", "radar client/client.pxn --radar radar/docking_x_band.toml --camera 0,-20,0 --look-at 0,0,0 -o echoes.csv", "stars --look-at 1,0,0 --fov 20 --stars 5", "lookup cubesat/cubesat.pxn --camera 2,-3,1 --fov 30 --pixel 512,512 --pixel 0,0 --sight 1,0,0,-1,0,0 --keypoints", "lookup client/client.pxn --camera 9,-9,6 --keypoints", "lookup none.pxn --nearest 0,0,0", "lidar cubesat/cubesat.pxn --lidar lidar/flash_rvd.toml --camera 20,-30,10 -o a.npz", "lidar cubesat/cubesat.pxn --lidar lidar/scanning_rvs.toml --camera 2,-3,1 -o a.csv", "lidar cubesat/cubesat.pxn --lidar none.toml -o a.npz", "camera cameras/wide_docking.toml", "camera none.toml", "dem terrain/crater.lbl -o crater.png", "dem terrain/crater.lbl -o crater.pan", "dem terrain/body.tab --unit km", "dem none.lbl", "labels labels --format coco -o labelled", "labels none --format coco -o others", "serve --coverage", "serve none.pxn", "dataset plan dataset/plan.toml -o set", "dataset check set", "dataset run none", "help", "help render", "version", "completion zsh", "info --wrong", "view none.pxn --size 1x1", "new probe", "new probe", "new a.b",
]
IMAGES = ["render cubesat/cubesat.pxn --size 16x16 -o a.png", "render cubesat/cubesat.pxn --size 8x8 -o a.exr --engine reference --samples 1", "render none.pxn", "run rendezvous/approach.toml --frames 0 --samples 1 -o frames", "run rendezvous/instruments.toml --frames 0 --samples 1 -o measured", "run none.toml -o x"]
# results that grow often: what they add is described when it is there to stay
GROWING = {"render", "run", "import", "info", "check", "material"}


def main():
    failures = 0
    seen = set()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder) / "work"
        shutil.copytree(SOURCE / "examples", work)
        (work / "wrong.pxn").write_text('<pangu_model ver="1">\n<spere radius="1"/><box size="1"/>\n</pangu_model>\n')
        (work / "table.txt").write_text("".join(f"{a} 0 {b} 180 {0.1 + 0.001 * a}\n" for a in range(0, 70, 10) for b in range(0, 70, 10)))
        for line in LINES + (IMAGES if GL else []):
            done = subprocess.run([PROGRAM, *line.split(), "--json"], cwd=work, capture_output=True, text=True, timeout=300)
            command = line.split()[0]
            seen.add(command)
            schema = json.loads((SOURCE / f"schemas/json/{command}.schema.json").read_text(encoding="utf-8"))
            try:
                found = list(problems(json.loads(done.stdout), schema, command, command not in GROWING))
            except json.JSONDecodeError as error:
                found = [f"not one JSON object: {error}"]
            for problem in found[:5]:
                print(f"panwright {line} --json: {problem}")
            failures += len(found)
    for path in (SOURCE / "schemas/json").glob("*.schema.json"):
        command = path.name.removesuffix(".schema.json")
        if command not in seen and (GL or command not in ("render", "run")):
            print(f"no line tests {command}")
            failures += 1
    # the validator finds what is wrong
    schema = json.loads((SOURCE / "schemas/json/export.schema.json").read_text(encoding="utf-8"))
    bad = {"schema": 1, "schema_id": "panwright/export/2", "command": "export", "exit_code": 0, "errors": "none", "extra": 1}
    if len(list(problems(bad, schema, "bad", True))) != 9:
        print("the validator misses what is wrong:", *problems(bad, schema, "bad", True), sep="\n  ")
        failures += 1
    return 1 if failures else 0


sys.exit(main())
