#include "labels/parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "base/text.h"

namespace panwright::labels {

namespace {

bool is_end(std::string_view path, std::string_view given) {
  if (path == given) return true;
  return path.size() > given.size() && path.ends_with(given) &&
         path[path.size() - given.size() - 1] == '/';
}

// The whole path, its end, or the target's name and the end.
bool is_path(std::string_view target, std::string_view path, std::string_view given) {
  if (is_end(path, given)) return true;
  const bool named =
      given.size() > target.size() && given.starts_with(target) && given[target.size()] == '/';
  return named && is_end(path, given.substr(target.size() + 1));
}

// The name of a node that is nearest to the last one of a path.
std::optional<std::string> nearest_node(const world::World& world, std::string_view given) {
  std::set<std::string> names;
  for (std::size_t t = 0; t < world.size(); ++t)
    for (std::size_t n = 0; n < world[t].model()->nodes().size(); ++n) {
      const std::string path = world[t].model()->node_path(n);
      names.insert(path.substr(path.rfind('/') + 1));
    }
  const std::vector<std::string_view> all(names.begin(), names.end());
  const auto near = nearest_name(given.substr(given.rfind('/') + 1), all);
  return near ? std::optional(std::string(*near)) : std::nullopt;
}

// The node of the shape that each node is the blanket of: its name and `_foil` beside it, as `foil`
// of a shape makes it; else itself.
std::vector<std::uint32_t> shapes_of(const pan::Model& model) {
  constexpr std::string_view kBlanket = "_foil";
  std::map<std::pair<std::int32_t, std::string_view>, std::uint32_t> by_name;
  const auto nodes = model.nodes();
  for (std::uint32_t n = 0; n < nodes.size(); ++n)
    by_name.try_emplace({nodes[n].parent, model.string(nodes[n].name)}, n);
  std::vector<std::uint32_t> shapes(nodes.size());
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    shapes[n] = n;
    std::string_view name = model.string(nodes[n].name);
    if (!name.ends_with(kBlanket)) continue;
    name.remove_suffix(kBlanket.size());
    if (const auto at = by_name.find({nodes[n].parent, name}); at != by_name.end())
      shapes[n] = at->second;
  }
  return shapes;
}

// Nodes of each label, in the order of the first.
using LabelledNodes = std::vector<std::pair<std::string, std::vector<std::uint32_t>>>;

LabelledNodes labelled_nodes(const world::Instance& target, const std::vector<ChosenPart>& chosen,
                             std::vector<char>& found) {
  LabelledNodes result;
  const pan::Model& model = *target.model();
  const auto add = [&](const std::string& label, std::uint32_t node) {
    auto at = std::ranges::find(result, label, &LabelledNodes::value_type::first);
    if (at == result.end()) at = result.insert(result.end(), {label, {}});
    if (at->second.empty() || at->second.back() != node) at->second.push_back(node);
  };
  const auto labels = model.labels();
  const std::vector<std::uint32_t> shapes = shapes_of(model);
  for (std::uint32_t node = 0; node < model.nodes().size(); ++node) {
    const std::uint32_t shape = shapes[node];
    // labels stand in the order of their nodes
    auto own = std::ranges::lower_bound(labels, shape, {}, &pan::layout::Label::node);
    for (; own != labels.end() && own->node == shape; ++own)
      if (const std::string_view label = model.string(own->name); !label.empty())
        add(std::string(label), node);
    const auto path_of = [&](std::uint32_t n) {
      return chosen.empty() ? "" : target.name() + "/" + model.node_path(n);
    };
    const std::string path = path_of(node), shape_path = shape == node ? path : path_of(shape);
    for (std::size_t k = 0; k < chosen.size(); ++k)
      if (is_path(target.name(), path, chosen[k].node) ||
          is_path(target.name(), shape_path, chosen[k].node)) {
        add(chosen[k].label, node);
        found[k] = 1;
      }
  }
  return result;
}

}  // namespace

Result<Things> named_things(const world::World& world, const std::vector<ChosenPart>& chosen,
                            DiagnosticLog& log) {
  const std::size_t errors = log.errors();
  Things result;
  std::vector<char> found(chosen.size());
  std::map<std::vector<std::uint32_t>, std::uint32_t> leaves;
  for (std::uint32_t t = 0; t < world.size(); ++t) {
    const auto nodes = world[t].model()->nodes();
    // the things of each node
    std::vector<std::vector<std::uint32_t>> of(nodes.size());
    const auto add = [&](const std::string& label, std::vector<std::uint32_t> roots) {
      const auto thing = static_cast<std::uint32_t>(result.things.size());
      std::vector<char> within(nodes.size());
      for (const std::uint32_t root : roots) within[root] = 1;
      // parents stand before their children
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (nodes[n].parent >= 0 && within[static_cast<std::size_t>(nodes[n].parent)])
          within[n] = 1;
        if (within[n]) of[n].push_back(thing);
      }
      result.things.push_back({t, label, std::move(roots)});
    };
    add("", {0});
    for (auto& [label, roots] : labelled_nodes(world[t], chosen, found))
      add(label, std::move(roots));
    auto& leaf_of = result.leaf_of.emplace_back(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const auto [at, fresh] =
          leaves.emplace(of[n], static_cast<std::uint32_t>(result.of_leaf.size()));
      if (fresh) result.of_leaf.push_back(of[n]);
      leaf_of[n] = at->second;
    }
  }
  for (std::size_t k = 0; k < chosen.size(); ++k)
    if (!found[k]) {
      const auto near = nearest_node(world, chosen[k].node);
      log.report(Code("E9005"), {},
                 fmt::format("the label {} is for {}, which is no node of a target",
                             in_quotes(chosen[k].label), in_quotes(chosen[k].node)),
                 fmt::format("{}nodes: panwright info MODEL --nodes",
                             near ? fmt::format("did you mean '{}'? ", *near) : ""));
    }
  if (log.errors() != errors) return failed;
  return result;
}

}  // namespace panwright::labels
