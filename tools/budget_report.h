// Report of an accuracy budget: requests, results, and the distribution of triangles, bytes and
// time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compiler/compile.h"
#include "scene/scene.h"
#include "tools/command_context.h"

namespace panwright::tools {

// Returns the JSON of docs/json-output.md.
nlohmann::ordered_json budget_json(const scene::Budget& budget, const compiler::Report& report);

// Returns lines of text.
std::string budget_text(const std::string& model, const scene::Budget& budget,
                        const compiler::Report& report);

// Returns one self-contained HTML page.
std::string budget_page(const std::string& model, const scene::Budget& budget,
                        const compiler::Report& report);

// Writes one of these, by the file's extension: .json, .html, else text.
//
//   model  as typed
// Fails: E0101 and other errors of writing.
bool write_budget_report(const std::string& file, const std::string& model,
                         const scene::Budget& budget, const compiler::Report& report,
                         CommandContext& context);

}  // namespace panwright::tools
