// Assembly of blankets: over one shape, and wrapped around all that fit a pattern.
#include <fmt/core.h>

#include "base/text.h"
#include "pxn/reader/internal/assembly.h"
#include "pxn/reader/pattern.h"

namespace panwright::pxn {

FoilWish Assembler::wish_of(Use& use, std::uint32_t element) {
  FoilWish wish;
  wish.document = &use.part->file->document;
  wish.where = wish.document->tag_span(element);
  wish.where.file = file_of(use);
  wish.element = element;
  return wish;
}

void Assembler::cover(Use& use, std::uint32_t element, std::int32_t instance,
                      std::string_view preset, std::int32_t named, const scene::Source& source) {
  const auto node =
      static_cast<std::size_t>(scene_.instances[static_cast<std::size_t>(instance)].node);
  FoilWish wish = wish_of(use, element);
  wish.on = {{instance, scene_.nodes[node].name + "_foil"}};
  wish.how.preset = preset;
  wish.blanket.material =
      named >= 0 ? surfaces_.named_material(named) : surfaces_.usual_material(preset);
  wish.blanket.source = source;
  blankets_.wish(std::move(wish));
}

void Assembler::wrap(Use& use, std::uint32_t index, const Context& around, std::int32_t top,
                     std::uint32_t first) {
  const Item& item = use.part->items[index];
  const PartWrap& known = use.part->wraps[item.data];
  std::vector<std::int32_t> on = wrapped_instances(use, known, top, first);
  if (on.empty()) return report_no_match(use, item, known, first);
  const NodeProperties* properties = properties_of(use, item);
  scene::Instance blanket;
  const bool bare = around.surface.name.empty() && around.surface.place.file == kNoFile;
  blanket.material =
      properties && properties->material >= 0 ? surfaces_.named_material(properties->material)
      : bare && !known.blanket.preset.empty() ? surfaces_.usual_material(known.blanket.preset)
                                              : surfaces_.material(around.surface);
  if (properties && properties->back)
    blanket.back = surfaces_.back_of(nullptr, blanket.material, *properties->back,
                                     [&] { return place_in(use, item); });
  blanket.source = source_of(use, item);
  const std::string name = properties && !properties->name.empty() ? properties->name : "foil";
  FoilWish wish = wish_of(use, item.element);
  for (const std::int32_t instance : on)
    wish.on.emplace_back(instance, on.size() == 1 ? name : numbered(name));
  wish.how = known.blanket;
  wish.axes_from_world = glm::inverse(around.world_from_node);
  wish.faces = known.faces;
  if (known.tape >= 0) wish.tape = surfaces_.named_material(known.tape);
  if (known.edge >= 0) wish.edge = surfaces_.named_material(known.edge);
  wish.blanket = std::move(blanket);
  blankets_.wish(std::move(wish));
}

std::vector<std::int32_t> Assembler::wrapped_instances(const Use& use, const PartWrap& wrap,
                                                       std::int32_t top,
                                                       std::uint32_t first) const {
  std::vector<char> named(scene_.nodes.size(), 1);
  if (wrap.on) named = matching_nodes(scene_, static_cast<std::uint32_t>(top), Pattern(*wrap.on));
  const Pattern material(wrap.materials.value_or("*"));
  const auto fit = [&](std::uint32_t begin, std::uint32_t end) {
    std::vector<std::int32_t> out;
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
      const scene::Instance& instance = scene_.instances[i];
      const auto node = static_cast<std::uint32_t>(instance.node);
      if (node >= begin && node < end && named[node] &&
          material.fits(scene_.materials[static_cast<std::size_t>(instance.material)].name))
        out.push_back(static_cast<std::int32_t>(i));
    }
    return out;
  };
  for (std::uint32_t run = wrap.run; run != kNoRun; run = use.part->runs[run].outer) {
    const Run& r = use.part->runs[run];
    if (auto out = fit(use.nodes_before[r.begin], use.nodes_before[r.end]); !out.empty())
      return out;
  }
  return fit(first, use.nodes_before.back());
}

void Assembler::report_no_match(Use& use, const Item& item, const PartWrap& wrap,
                                std::uint32_t first) {
  report_at(Code("W1501"), use, item.element, [&]() -> Reporter::Text {
    std::set<std::string> names;
    for (std::size_t i = first; i < scene_.nodes.size() && wrap.on; ++i)
      names.insert(scene_.nodes[i].name);
    for (std::size_t i = 0; i < scene_.instances.size() && !wrap.on; ++i)
      names.insert(scene_.materials[static_cast<std::size_t>(scene_.instances[i].material)].name);
    const std::string& pattern = wrap.on ? *wrap.on : *wrap.materials;
    return {fmt::format("no shape is covered: none at or below a {} that fits {}{}",
                        wrap.on ? "node" : "material", in_quotes(pattern),
                        wrap.on && wrap.materials ? fmt::format(" has a material that fits {}",
                                                                in_quotes(*wrap.materials))
                                                  : ""),
            near_names(pattern, names)};
  });
}

}  // namespace panwright::pxn
