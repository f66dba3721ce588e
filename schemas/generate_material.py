#!/usr/bin/env python3
"""Makes everything that knows a material parameter by name from schemas/material.toml: see there.

generate_material.py            writes it
generate_material.py --check    fails, and names the file, when one of them differs from what it would write
"""

import sys

import generated_files
from material_cpp import header_text, source_text
from material_formulas import (choice_text, fields_def, formula_table_text, generated_formula_files, loader_text,
                               parameters_glsl, surface_of_text)
from material_pan import pan_text
from material_schema import SchemaError, load


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


def marked(name, text):
    """C++ that is not formatted says so."""
    if "clang-format" in text or not name.endswith((".h", ".cpp", ".inl")):
        return text
    return text.replace("Do not edit.\n", "Do not edit.\n// clang-format off\n", 1)


def make():
    return {name: marked(name, text) for name, text in texts(load()).items()}


if __name__ == "__main__":
    sys.exit(generated_files.run("generate_material.py", sys.argv[1:], make, SchemaError, "material.toml"))
