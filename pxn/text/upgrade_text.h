// One document of level 0 in the words of level 1.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "pxn/text/xml.h"

namespace panwright::pxn {

// What an include or texture of level 0 is called from the file's own folder, as UTF-8; nothing: it
// cannot be found, and stays.
using NewPath = std::function<std::optional<std::string>(const std::string& file)>;

// Where a path changed.
using PathChanged =
    std::function<void(SourceSpan where, const std::string& from, const std::string& to)>;

// The text; layout is left to formatted().
//
// Expects: a document that check_grammar has seen, without errors.
std::string upgraded_text(const xml::Document& document, const NewPath& new_path,
                          const PathChanged& path_changed);

}  // namespace panwright::pxn
