#include "importers/internal/lost.h"

#include <fmt/core.h>

#include <tuple>

namespace panwright::importers {

bool is_before(const SourceSpan& place, const SourceSpan& other) {
  // note: no file is the largest number
  return std::tie(place.file, place.begin) < std::tie(other.file, other.begin);
}

void LostProperties::add(std::string_view what, SourceSpan where) {
  constexpr std::size_t kMost = 30;
  auto place = known_.find(what);
  if (place == known_.end())
    place = known_.try_emplace(std::string(known_.size() < kMost ? what : "others")).first;
  ++place->second.count;
  if (is_before(where, place->second.where)) place->second.where = where;
}

void LostProperties::report(SourceSpan whole, DiagnosticLog& log) const {
  if (known_.empty()) return;
  SourceSpan first;
  for (const auto& [what, known] : known_)
    if (is_before(known.where, first)) first = known.where;
  const SourceMap& sources = log.sources();
  const auto line_of = [&](SourceSpan where) -> std::uint32_t {
    if (where.file == kNoFile || !sources.file(where.file).bytes) return 0;
    return sources.position(where.file, where.begin).line;
  };
  std::string list;
  for (const auto& [what, known] : known_) {
    std::string more = known.count == 1 ? "" : std::to_string(known.count);
    const std::uint32_t line = line_of(known.where);
    const bool same_file = known.where.file == first.file;
    if (line > 0 && !(same_file && line == line_of(first))) {
      if (!more.empty()) more += ", ";
      if (!same_file) more += sources.file(known.where.file).name + ", ";
      more += fmt::format("line {}", line);
    }
    list += fmt::format("{}{}{}", list.empty() ? "" : ", ", what,
                        more.empty() ? "" : fmt::format(" ({})", more));
  }
  log.report(Code("W6008"), first.file == kNoFile ? whole : first,
             "unsupported properties ignored: " + list);
}

}  // namespace panwright::importers
