// HTML pages of reports.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace panwright::tools {

// Returns one self-contained page: tools/templates/report.html with a report in it,
//   {"title", "kind", "sections": [{"title", "cards": [[value, words]], "text",
//    "table": {"words", "columns": [text], "rows": [[cell]]}, "images": [{"source", "caption"}]}]}
// Members of a section may be absent. A cell is a text, a number, [text, remark], or a bar
// {"share", "color"}. A table with "words" is aligned to the left. Texts may hold any bytes.
std::string report_page(const nlohmann::ordered_json& report);

}  // namespace panwright::tools
