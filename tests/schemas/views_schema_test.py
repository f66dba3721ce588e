#!/usr/bin/env python3
"""The JSON schema of views has every option of `render`, and takes the examples of its page.

views_schema_test.py PANWRIGHT SOURCES
"""

import json
import pathlib
import re
import subprocess
import sys

PROGRAM, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])
# of the process, not of a view; and other ways to name what a view has
PROCESS = {"help", "explain", "json", "sarif", "quiet", "timings", "color", "threads", "gl", "views", "again", "root", "max-input", "max-error",
           "budget", "max-triangles", "no-cache", "units", "up-axis", "keep-hidden", "no-weld", "weld", "crease", "crease-normals",
           "scene", "primitives", "deflection", "max-seconds", "assume", "recentre", "animation", "time", "joints",
           "labels"}


def kinds(schema, value):
    """Whether one value has a type that the schema names: no validator is at hand everywhere."""
    if "anyOf" in schema:
        return any(kinds(each, value) for each in schema["anyOf"])
    if "enum" in schema:
        return value in schema["enum"]
    kind = schema["type"]
    if kind == "array":
        return isinstance(value, list) and all(kinds(schema["items"], each) for each in value)
    if kind == "object":
        return isinstance(value, dict) and all(kinds(schema["additionalProperties"], each) for each in value.values())
    if kind == "string" and "pattern" in schema:
        return isinstance(value, str) and re.search(schema["pattern"], value) is not None
    types = {"string": str, "boolean": bool, "number": (int, float), "integer": int}
    return isinstance(value, types[kind]) and (kind == "boolean" or not isinstance(value, bool))


def main():
    members = json.loads((ROOT / "schemas/views.schema.json").read_text(encoding="utf-8"))["$defs"]["view"]["properties"]
    said = subprocess.run([PROGRAM, "render", "--help"], capture_output=True, text=True, check=True).stdout
    options = set(re.findall(r"^\s+(?:-\w,\s*)?--([a-z][a-z-]+)", said, re.MULTILINE))
    missing = options - PROCESS - set(members)
    problems = [f"--{name} of render is no member of a view" for name in sorted(missing)]
    if len(options) < 30:
        problems.append("the help of render was not understood")
    page = (ROOT / "docs/views.md").read_text(encoding="utf-8")
    examples = [json.loads(f'{{"{name}": {value}}}') for name, value in re.findall(r"^\| `([\w-]+)` \| `(.+?)` \|", page, re.MULTILINE)
                if name in members and value[0] in '[{"0123456789t']
    for block in re.findall(r"```json\n(\[.*?)```", page, re.DOTALL):
        examples += json.loads(block)
    if len(examples) < 35:
        problems.append("the examples of docs/views.md were not found")
    for example in examples:
        for name, value in example.items():
            if name not in members or not kinds(members[name], value):
                problems.append(f"docs/views.md: {name}: {json.dumps(value)} is not as the schema says")
    print("\n".join(problems))
    return 1 if problems else 0


sys.exit(main())
