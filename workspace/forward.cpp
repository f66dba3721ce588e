#include <fmt/core.h>

#include "base/text.h"
#include "workspace/internal/forward.h"

namespace panwright::workspace {

namespace {

// "--fov is …" as an option of the command line, "fov is …" as a member of a view.
std::string without_dashes(const std::string& message) {
  std::string out;
  for (std::size_t i = 0; i < message.size(); ++i) {
    const bool begins = i == 0 || message[i - 1] == ' ';
    if (begins && message.compare(i, 2, "--") == 0)
      ++i;
    else
      out += message[i];
  }
  return out;
}

}  // namespace

namespace {

// The text of an entry in the log it goes to, so that its line is known there.
SourceSpan moved_place(const SourceSpan& where, const SourceMap& from, SourceMap& to) {
  const SourceFile& file = from.file(where.file);
  if (!file.bytes || file.included_at.file != kNoFile) return {};
  for (FileId id = 0; id < to.size(); ++id)
    if (to.file(id).name == file.name && to.file(id).bytes &&
        to.file(id).bytes->data() == file.bytes->data())
      return {id, where.begin, where.end};
  return {to.add(file), where.begin, where.end};
}

}  // namespace

void forward(const DiagnosticLog& from, const std::string& label, std::string_view file,
             DiagnosticLog& to, std::optional<Code> except) {
  for (const Diagnostic& each : from.entries()) {
    if (each.code == except) continue;
    std::string name =
        each.where.file == kNoFile ? std::string() : from.sources().file(each.where.file).name;
    if (each.where.file != kNoFile) {
      const SourceSpan place = moved_place(each.where, from.sources(), to.sources());
      if (place.file != kNoFile && each.code != Code("E0201")) {
        to.report(each.code, place, label.empty() ? each.message : label + ": " + each.message,
                  each.hint, each.object);
        continue;
      }
    }
    if (label.empty()) {
      to.report_file(each.code, name, each.message, each.hint);
      continue;
    }
    const bool usage = each.code == Code("E0201");
    if (name.empty()) name = file;
    to.report_file(usage ? Code("E0203") : each.code, name,
                   label + ": " + (usage ? without_dashes(each.message) : each.message), each.hint);
  }
}

std::string view_label(std::size_t index, const std::string& name) {
  return name.empty() ? fmt::format("view {}", index)
                      : fmt::format("view {} ({})", index, in_quotes(name));
}

}  // namespace panwright::workspace
