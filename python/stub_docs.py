#!/usr/bin/env python3
"""Makes C++ of the docstrings of a stub, so that help() and type checkers show the same text.

    stub_docs.py STUB OUTPUT
"""
import ast
import pathlib
import sys

stub, output = map(pathlib.Path, sys.argv[1:])
text = stub.read_text(encoding="utf-8")
lines = text.splitlines()
docs = {}


def comment_of(node):
    """A member of one line has its text behind it."""
    line = lines[node.end_lineno - 1]
    return line.split("  # ", 1)[1] if "  # " in line else None


def take(node, prefix):
    for each in node.body:
        if isinstance(each, (ast.ClassDef, ast.FunctionDef)):
            doc = ast.get_docstring(each) or comment_of(each)
            if doc:
                docs[prefix + each.name] = doc
        if isinstance(each, ast.ClassDef):
            take(each, each.name + ".")


take(ast.parse(text), "")
pairs = "".join(f'    {{"{name}", R"doc({doc})doc"}},\n' for name, doc in sorted(docs.items()))
output.write_text(f'''#include "python/docs.h"

#include <algorithm>
#include <array>
#include <utility>

namespace panwright::python {{

namespace {{
constexpr std::pair<std::string_view, const char*> kDocs[] = {{
{pairs}}};
}}  // namespace

const char* doc(std::string_view name) {{
  const auto found = std::ranges::find(kDocs, name, [](const auto& each) {{ return each.first; }});
  return found == std::end(kDocs) ? "" : found->second;
}}

}}  // namespace panwright::python
''', encoding="utf-8")
