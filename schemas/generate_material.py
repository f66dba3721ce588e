#!/usr/bin/env python3
"""Makes everything that knows a material parameter by name from schemas/material.toml: see there.

generate_material.py            writes it
generate_material.py --check    fails, and names the file, when one of them differs from what it would write
"""

import sys

from material_cpp import header_text, source_text
from material_formulas import (choice_text, fields_def, formula_table_text, generated_formula_files, loader_text,
                               parameters_glsl, surface_of_text)
from material_pan import pan_text
from material_schema import ROOT, SchemaError, load


def texts(schema):
    includes, externs, cmake = generated_formula_files(schema)
    inner = "materials/internal/generated/"
    return {
        "materials/generated/material_record.h": header_text(schema),
        "materials/generated/material_record.cpp": source_text(schema),
        inner + "parameters.glsl": parameters_glsl(schema),
        inner + "surface_fields.def": fields_def(schema),
        inner + "surface_of.inl": surface_of_text(schema),
        inner + "material_loader.inl": loader_text(schema),
        inner + "brdf_choice.inl": choice_text(schema),
        inner + "formula_table.inl": formula_table_text(schema),
        inner + "formula_includes.inl": includes,
        inner + "formula_externs.inl": externs,
        inner + "formulas.cmake": cmake,
        "pan/generated/material_record.cpp": pan_text(schema),
    }


def main(arguments):
    if arguments not in ([], ["--check"]):
        print("usage: generate_material.py [--check]", file=sys.stderr)
        return 2
    try:
        made = texts(load())
    except SchemaError as error:
        print(f"material.toml: {error}", file=sys.stderr)
        return 1
    stale = 0
    for name, text in made.items():
        if "clang-format" not in text and name.endswith((".h", ".cpp", ".inl")):
            text = text.replace("Do not edit.\n", "Do not edit.\n// clang-format off\n", 1)
        path = ROOT / name
        if arguments:
            if not path.exists() or path.read_text(encoding="utf-8") != text:
                print(f"{name} is not what schemas/generate_material.py makes: run it", file=sys.stderr)
                stale = 1
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")
    return stale


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
