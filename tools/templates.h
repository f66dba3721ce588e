// Files held in the program.
#pragma once

#include <string>

namespace panwright::tools {

std::string project_text();          // tools/templates/project.pxn
std::string schema_text();           // schemas/pxn.xsd
std::string report_template_text();  // tools/templates/report.html
std::string font_file();             // DejaVu Sans Mono, as TrueType

}  // namespace panwright::tools
