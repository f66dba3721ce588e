// Template files written for beginners.
#pragma once

#include <string>

namespace panwright::tools {

std::string project_text();  // tools/templates/project.pxn
std::string schema_text();   // schemas/pxn.xsd

}  // namespace panwright::tools
