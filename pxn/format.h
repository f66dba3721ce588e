// Formatter of pxn texts to their canonical form.
#pragma once

#include <memory>
#include <string>

#include "base/diagnostic.h"
#include "base/result.h"
#include "pxn/pxn.h"

namespace panwright::pxn {

// Formats a text of any level, unknown elements included. Only blanks and the order of attributes
// change: comments, processing instructions, CDATA sections, references and the encoding stay.
// Formatting twice changes nothing more.
//
// The form: one element a line, indented by two blanks for each one around it. Elements without
// children are on one line with their text; <a></a> is written <a/>. Attributes are in double
// quotes, ver, name, part and file first, the others in the author's order. Start tags of more than
// 100 columns have one attribute a line; longer texts are wrapped there, lists of points between
// points. At most one blank line stays between elements, and a comment stays on the line of its
// preceding element. Blanks stay in elements of xml:space="preserve"; text beside elements stays
// adjacent. Lines end in LF.
//
//   name, bytes  of the file
//   returns      the text, in the encoding of the file; verified to mean the same as the original
//
// Fails: E0104 for 4 GiB or more, E1001 to E1008. Throws std::logic_error when the texts do not
// mean the same, which is a bug. Cost: O(bytes); memory about 4 times the text.
[[nodiscard]] Result<std::string> formatted(const std::string& name,
                                            std::shared_ptr<const std::string> bytes,
                                            const Limits& limits, DiagnosticLog& log);

}  // namespace panwright::pxn
