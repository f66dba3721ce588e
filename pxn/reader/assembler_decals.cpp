// Assembly of decals, once the shapes of their part are there.
#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "pxn/reader/internal/assembly.h"
#include "pxn/text/grammar.h"

namespace panwright::pxn {

void Assembler::decal(Use& use, const Item& item) {
  const PartDecal& known = use.part->decals[item.data];
  const auto on = use.shapes.find(known.on);
  if (on == use.shapes.end()) {
    if (missing_.insert({use.part, item.element}).second && !is_written(*use.part, known.on))
      report_missing_shape(use, item, known.on);
    return;
  }
  if (known.decal.texture == scene::kNone) return;  // wrong, already reported
  const auto& all = on->second;
  auto first = all.begin();
  auto last = all.end();
  for (std::uint32_t run = known.run; run != kNoRun; run = use.part->runs[run].outer) {
    const auto before = [](const auto& shape, std::uint32_t index) { return shape.first < index; };
    const auto from = std::lower_bound(all.begin(), all.end(), use.part->runs[run].begin, before);
    const auto to = std::lower_bound(from, all.end(), use.part->runs[run].end, before);
    if (from == to) continue;
    first = from;
    last = to;
    break;
  }
  for (; first != last; ++first) {
    if (scene_.decals.size() >= options_.limits.nodes) {
      report(Code("E1008"), use, item, [&] {
        return Reporter::Text(
            fmt::format("the model has more than {} decals", options_.limits.nodes));
      });
      stopped_ = true;
      return;
    }
    scene::Decal decal = known.decal;
    decal.instance = first->second;
    decal.source = source_of(use, item);
    scene_.decals.push_back(std::move(decal));
  }
}

bool Assembler::is_written(const Part& part, std::string_view name) {
  const xml::Document& document = part.file->document;
  const std::uint32_t end = document.elements[part.element].next;
  for (std::uint32_t e = part.element + 1; e < end; ++e)
    if (const xml::Attribute* given = find_attribute(document, e, "name")) {
      const std::string written = xml::decoded(document, given->value_begin, given->value_end);
      if (written == name && document.elements[e].id != schemas::ElementId::decal) return true;
      if (written.find('{') != std::string::npos &&
          name.substr(0, written.find('{')) == written.substr(0, written.find('{')))
        return true;
    }
  return false;
}

void Assembler::report_missing_shape(Use& use, const Item& item, const std::string& name) {
  report(Code("E1311"), use, item, [&]() -> Reporter::Text {
    std::vector<std::string_view> names;
    for (const auto& [other, instances] : use.shapes) names.push_back(other);
    const auto near = nearest_name(name, names);
    return {fmt::format("no shape of this {} has the name {}",
                        use.part->element == 0 ? "file" : "part", in_quotes(name)),
            near ? fmt::format("did you mean '{}'?", *near) : ""};
  });
}

}  // namespace panwright::pxn
