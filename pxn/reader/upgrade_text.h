// Conversion of one document from level 0 to level 1.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pxn/text/xml.h"

namespace panwright::pxn {

// Path of a level-0 include or texture from the file's own folder, as UTF-8; nothing: not found,
// unchanged.
using NewPath = std::function<std::optional<std::string>(const std::string& file)>;

// Callback for a changed path.
using PathChanged =
    std::function<void(SourceSpan where, const std::string& from, const std::string& to)>;

// Returns the text; layout is left to formatted().
//
// Expects: a document without errors by check_grammar.
std::string upgraded_text(const xml::Document& document, const NewPath& new_path,
                          const PathChanged& path_changed);

}  // namespace panwright::pxn
