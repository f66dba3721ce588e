// HTML pages of reports.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace panwright::tools {

// Returns one self-contained page: tools/templates/report.html with a report in it. Its members are
// sections, in order: a text, an object of values, a list of objects of values, or a list of
// {"image", "caption"} with images as data URIs. Texts may hold any bytes.
std::string report_page(const std::string& title, const nlohmann::ordered_json& report);

}  // namespace panwright::tools
