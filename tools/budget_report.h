// What a budget asked for, what came of it, and where triangles, bytes and time went.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "compiler/compile.h"
#include "scene/scene.h"
#include "tools/command_context.h"

namespace panwright::tools {

// As docs/json-output.md has it.
nlohmann::ordered_json budget_json(const scene::Budget& budget, const compiler::Report& report);

// For people, in lines.
std::string budget_text(const std::string& model, const scene::Budget& budget,
                        const compiler::Report& report);

// One HTML page, with nothing outside it.
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
