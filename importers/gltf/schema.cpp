#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "base/text.h"
#include "importers/gltf/document.h"
#include "importers/gltf/schema_text.h"

namespace panwright::importers::gltf {

namespace {

using Kind = Json::Kind;

// One kind of value, as a word of the table.
struct Rule {
  std::string_view name;
  std::string_view kind;    // "id", "nums"…
  std::string_view target;  // after the point: a collection or type
  std::size_t length = 0;   // of nums; 0: any
  bool needed = false;
  bool open_below = false;  // the lower bound itself is not allowed
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  std::vector<std::string_view> words;
};

struct Type {
  std::string_view name;
  std::vector<Rule> rules;
};

struct Table {
  std::map<std::string_view, Type> types;
  std::map<std::pair<std::string_view, std::string_view>, Type> extensions;  // by name and type
  std::map<std::string_view, bool> known;
};

std::vector<std::string_view> split(std::string_view text, char mark) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(mark), text.size());
    if (end > 0) parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return parts;
}

Rule rule_from(std::string_view word) {
  Rule rule;
  const std::size_t equals = word.find('=');
  rule.name = word.substr(0, equals);
  if (rule.name.ends_with('!')) {
    rule.needed = true;
    rule.name.remove_suffix(1);
  }
  std::string_view rest = word.substr(equals + 1);
  if (const std::size_t bracket = rest.find('('); bracket != rest.npos) {
    rule.words = split(rest.substr(bracket + 1, rest.size() - bracket - 2), ',');
    rest = rest.substr(0, bracket);
  }
  if (const std::size_t colon = rest.find(':'); colon != rest.npos) {
    rule.length = static_cast<std::size_t>(*parse_double(rest.substr(colon + 1)));
    rest = rest.substr(0, colon);
  }
  const std::size_t point = rest.find('.');
  rule.kind = rest.substr(0, point);
  if (point != rest.npos) rule.target = rest.substr(point + 1);
  const bool bounds = rule.kind == "int" || rule.kind == "num" || rule.kind == "nums";
  if (bounds && !rule.words.empty()) {
    std::string_view low = rule.words[0];
    rule.open_below = low.starts_with('>');
    if (rule.open_below) low.remove_prefix(1);
    rule.low = *parse_double(low);
    if (rule.words.size() > 1) rule.high = *parse_double(rule.words[1]);
  }
  return rule;
}

Table make_table() {
  Table table;
  for (const std::string_view line : split(kSchema, '\n')) {
    std::vector<std::string_view> words = split(line, ' ');
    const bool extension = words[0].starts_with('@');
    Type type{words[0], {}};
    for (std::size_t i = extension ? 2 : 1; i < words.size(); ++i)
      type.rules.push_back(rule_from(words[i]));
    if (!extension) {
      table.types[words[0]] = type;
      continue;
    }
    table.known[words[0].substr(1)] = true;
    for (const std::string_view owner : split(words[1], '|'))
      table.extensions[{words[0].substr(1), owner}] = type;
  }
  return table;
}

const Table& table() {
  static const Table made = make_table();
  return made;
}

// Where the pass is: text is made of it only when something is wrong.
struct Path {
  const Path* up;
  std::string_view key;
  std::size_t index = 0;
  bool is_index = false;

  std::string text() const {
    if (!up) return {};
    return up->text() + "/" + (is_index ? fmt::format("{}", index) : std::string(key));
  }

  // The property alone, as `translation[2]`.
  std::string name() const {
    if (!up) return "the file";
    return is_index ? fmt::format("{}[{}]", up->name(), index) : std::string(key);
  }
};

std::string shown(const Json& value) {
  switch (value.kind) {
    case Kind::null:
      return "null";
    case Kind::boolean:
      return value.number != 0 ? "true" : "false";
    case Kind::number:
      return format_double(value.number);
    case Kind::string:
      return in_quotes(value.text);
    case Kind::array:
      return "a list";
    case Kind::object:
      return "an object";
  }
  return {};
}

class SchemaPass {
 public:
  explicit SchemaPass(Document& document) : document_(document) {
    for (const Rule& rule : table().types.at("root").rules)
      if (rule.kind == "list") sizes_[rule.name] = document.root.list(rule.name).size();
    const Json* all = document.root.find("extensions");
    for (const auto& [extension, list] : {std::pair("KHR_lights_punctual", "lights"),
                                          std::pair("KHR_materials_variants", "variants")})
      if (const Json* found = all ? all->find(extension) : nullptr)
        sizes_[list] = found->list(list).size();
  }

  void run() {
    const Path top{nullptr, {}};
    object(table().types.at("root"), document_.root, top);
    extensions("root", document_.root, top);
  }

 private:
  void report(Code code, const Json& at, const Path& path, std::string message,
              std::string hint = {}) {
    document_.report(code, &at, path.text(), std::move(message), std::move(hint));
  }

  bool wrong_type(const Json& value, const Path& path, std::string_view wanted) {
    report(Code("E6204"), value, path,
           fmt::format("{} is {}, expected {}", path.name(), shown(value), wanted));
    return false;
  }

  // Checks an object; what is wrong with a property takes it out.
  void object(const Type& type, Json& value, const Path& path) {
    for (const Rule& rule : type.rules) {
      Json* property = value.find(rule.name);
      const Path at{&path, rule.name};
      if (!property) {
        if (!rule.needed) continue;
        report(Code("E6204"), value, path, fmt::format("'{}' is missing", rule.name),
               near_name(rule.name, value));
        value.broken = true;
      } else if (!check(rule, *property, at)) {
        value.erase(rule.name);
        if (rule.needed) value.broken = true;
      }
    }
    extra_rules(type.name, value, path);
  }

  std::string near_name(std::string_view name, const Json& value) {
    const std::string_view wanted[] = {name};
    for (const std::string& key : value.keys)
      if (nearest_name(key, wanted)) return fmt::format("did you mean it by {}?", in_quotes(key));
    return {};
  }

  bool check(const Rule& rule, Json& value, const Path& path) {
    const std::string_view kind = rule.kind;
    if (kind == "any") return true;
    if (kind == "bool") return value.is(Kind::boolean) || wrong_type(value, path, "true or false");
    if (kind == "str" || kind == "uri")
      return value.is(Kind::string) || wrong_type(value, path, "a string");
    if (kind == "num" || kind == "int") return number(rule, value, path, kind == "int");
    if (kind == "id") return index(rule, value, path);
    if (kind == "word" || kind == "enum") return choice(rule, value, path);
    if (kind == "obj") {
      if (!value.is(Kind::object)) return wrong_type(value, path, "an object");
      object(table().types.at(rule.target), value, path);
      extensions(rule.target, value, path);
      return !value.broken;
    }
    if (kind == "map" || kind == "ints") return map(rule, value, path);
    return list(rule, value, path);
  }

  bool number(const Rule& rule, Json& value, const Path& path, bool whole) {
    if (!value.is(Kind::number) || (whole && !value.integral))
      return wrong_type(value, path, whole ? "an integer" : "a number");
    const double x = value.number;
    if ((rule.open_below ? x > rule.low : x >= rule.low) && x <= rule.high) return true;
    const double within = std::clamp(x, rule.low, rule.high);
    const std::string problem =
        std::isinf(rule.high)
            ? fmt::format("{} is {}, expected {} {}", path.name(), format_double(x),
                          rule.open_below ? "above" : "at least", format_double(rule.low))
            : fmt::format("{} is {}, expected {} to {}", path.name(), format_double(x),
                          format_double(rule.low), format_double(rule.high));
    // factors of materials, and what is not read; a rotation has no nearest value
    if (whole || rule.name == "rotation") {
      report(Code("E6204"), value, path, problem);
      return false;
    }
    report(Code("W6215"), value, path,
           rule.open_below ? problem + "; it is left out"
                           : fmt::format("{}; {} is taken", problem, format_double(within)));
    value.number = within;
    return !rule.open_below;
  }

  bool index(const Rule& rule, const Json& value, const Path& path) {
    if (!value.is(Kind::number) || !value.integral || value.number < 0)
      return wrong_type(value, path, "an index, 0 or more");
    const std::size_t size = sizes_[rule.target];
    if (value.number < static_cast<double>(size)) return true;
    report(Code("E6205"), value, path,
           fmt::format("{}[{}] does not exist; the file has {}", rule.target,
                       format_double(value.number), size));
    return false;
  }

  // A value that is not on the list is a warning to the official validator too.
  bool choice(const Rule& rule, const Json& value, const Path& path) {
    const bool word = rule.kind == "word";
    if (word ? !value.is(Kind::string) : !(value.is(Kind::number) && value.integral))
      return wrong_type(value, path, word ? "a string" : "an integer");
    const std::string text = word ? value.text : format_double(value.number);
    if (std::find(rule.words.begin(), rule.words.end(), text) != rule.words.end()) return true;
    const auto near = word ? nearest_name(text, rule.words) : std::nullopt;
    report(Code("W6215"), value, path,
           fmt::format("{} is {}, expected one of {}", path.name(), shown(value),
                       fmt::join(rule.words, ", ")),
           near ? fmt::format("did you mean '{}'?", *near) : "");
    return false;
  }

  bool map(const Rule& rule, Json& value, const Path& path) {
    if (!value.is(Kind::object)) return wrong_type(value, path, "an object");
    std::vector<std::string> wrong;
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      const Path at{&path, value.keys[i]};
      Rule whole;
      whole.low = 0;
      const bool good = rule.kind == "ints" ? number(whole, value.items[i], at, true)
                                            : index(rule, value.items[i], at);
      if (!good) wrong.push_back(value.keys[i]);
    }
    if (value.items.empty())
      report(Code("W6215"), value, path, "an empty object; the property could be left out");
    for (const std::string& key : wrong) value.erase(key);
    value.broken = !wrong.empty();
    return true;
  }

  bool list(const Rule& rule, Json& value, const Path& path) {
    if (!value.is(Kind::array)) return wrong_type(value, path, "a list");
    if (value.items.empty() && rule.length == 0 && rule.kind != "bounds") {
      report(Code("W6215"), value, path, "an empty list; the property could be left out");
      return false;
    }
    if (rule.length != 0 && value.items.size() != rule.length) {
      report(Code("E6204"), value, path,
             fmt::format("{} has {}, expected {}", path.name(),
                         counted(value.items.size(), "number"), rule.length));
      return false;
    }
    if (rule.kind == "ids") return ids(rule, value, path);
    bool good = true;
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      Json& item = value.items[i];
      const Path at{&path, {}, i, true};
      if (rule.kind == "nums" || rule.kind == "bounds")
        good = number(rule, item, at, false) && good;
      else if (rule.kind == "strs")
        good = text_of_list(value.items, i, at) && good;
      else if (rule.kind == "maps")
        element_map(rule, item, at);
      else
        element(rule, item, at);
    }
    return good;
  }

  // A name that stands twice is reported and kept.
  bool text_of_list(const std::vector<Json>& items, std::size_t i, const Path& at) {
    if (!items[i].is(Kind::string)) return wrong_type(items[i], at, "a string");
    const auto end = items.begin() + static_cast<std::ptrdiff_t>(i);
    const auto equal = [&](const Json& item) { return item.text == items[i].text; };
    if (std::find_if(items.begin(), end, equal) != end)
      report(Code("E6204"), items[i], at, fmt::format("{} repeats {}", at.name(), shown(items[i])));
    return true;
  }

  void element_map(const Rule& rule, Json& item, const Path& at) {
    if (map(rule, item, at)) return;
    item = Json{};
    item.kind = Kind::object;
    item.broken = true;
  }

  // An object of a list keeps its place whatever is wrong with it.
  void element(const Rule& rule, Json& item, const Path& at) {
    if (!item.is(Kind::object)) {
      wrong_type(item, at, "an object");
      const std::uint32_t offset = item.offset;
      item = Json{};
      item.kind = Kind::object;
      item.broken = true;
      item.offset = offset;
      return;
    }
    object(table().types.at(rule.target), item, at);
    extensions(rule.target, item, at);
  }

  bool ids(const Rule& rule, Json& value, const Path& path) {
    std::set<double> seen;
    std::vector<Json> good;
    for (std::size_t i = 0; i < value.items.size(); ++i) {
      const Path at{&path, {}, i, true};
      if (!index(rule, value.items[i], at)) continue;
      if (!seen.insert(value.items[i].number).second) {
        report(Code("E6204"), value.items[i], at,
               fmt::format("{} repeats the index {}", at.name(),
                           format_double(value.items[i].number)));
        continue;
      }
      good.push_back(value.items[i]);
    }
    const bool whole = good.size() == value.items.size();
    value.items = std::move(good);
    // a list of joints is referred to by place
    return whole || rule.name != "joints";
  }

  void extensions(std::string_view owner, Json& value, const Path& path) {
    Json* all = value.find("extensions");
    if (!all) return;
    const Path at{&path, "extensions"};
    if (!all->is(Kind::object)) {
      wrong_type(*all, at, "an object");
      value.erase("extensions");
      return;
    }
    std::vector<std::string> drop;
    for (std::size_t i = 0; i < all->items.size(); ++i) {
      const std::string& name = all->keys[i];
      Json& extension = all->items[i];
      const Path here{&at, name};
      const bool known = table().known.contains(name);
      const auto type = table().extensions.find({name, owner});
      if (!document_.used.contains(name) && undeclared_.insert(name).second)
        report(Code("W6215"), extension, here, "the extension is not listed in extensionsUsed");
      if (!extension.is(Kind::object)) {
        wrong_type(extension, here, "an object");
        drop.push_back(name);
      } else if (type != table().extensions.end()) {
        object(type->second, extension, here);
        extensions("extension", extension, here);
        if (extension.broken) drop.push_back(name);
      } else if (known) {
        report(Code("W6215"), extension, here, "the extension has no meaning in this place");
        drop.push_back(name);
      }
    }
    for (const std::string& name : drop) {
      all->erase(name);
      // what was packed is lost
      if (owner == "primitive" && name == "KHR_draco_mesh_compression") value.broken = true;
      if (owner == "bufferView" && name.ends_with("_meshopt_compression")) value.broken = true;
    }
  }

  void depends(Json& value, const Path& path, std::string_view property, std::string_view on) {
    const Json* there = value.find(property);
    if (!there || value.find(on)) return;
    report(Code("E6204"), *there, Path{&path, property},
           fmt::format("'{}' requires '{}'", property, on));
    value.erase(property);
  }

  void one_of(Json& value, const Path& path, std::string_view a, std::string_view b) {
    if ((value.find(a) != nullptr) != (value.find(b) != nullptr)) return;
    report(Code("E6204"), value, path, fmt::format("exactly one of '{}' and '{}' is needed", a, b));
  }

  // A camera has what its type says, and no other.
  void camera(Json& value, const Path& path) {
    const Json* type = value.find("type");
    if (!type) return;
    if (value.find("orthographic") && value.find("perspective"))
      report(Code("E6204"), value, path,
             "only one of 'orthographic' and 'perspective' may be given");
    else if (!value.find(type->text))
      report(Code("E6204"), value, path, fmt::format("'{}' is missing", type->text));
  }

  void variants(const Json& value, const Path& path) {
    std::set<double> seen;
    for (const Json& mapping : value.list("mappings"))
      for (const Json& variant : mapping.list("variants"))
        if (!seen.insert(variant.number).second)
          report(Code("E6204"), variant, Path{&path, "mappings"},
                 fmt::format("variant {} is mapped twice", format_double(variant.number)));
  }

  // What the table cannot say.
  void extra_rules(std::string_view type, Json& value, const Path& path) {
    if (type == "accessor") depends(value, path, "byteOffset", "bufferView");
    if (type == "node") {
      depends(value, path, "skin", "mesh");
      depends(value, path, "weights", "mesh");
    }
    if (type == "image") {
      one_of(value, path, "uri", "bufferView");
      depends(value, path, "bufferView", "mimeType");
    }
    if (type == "animation") {
      const std::size_t samplers = value.list("samplers").size();
      const std::vector<Json>& channels = value.list("channels");
      for (std::size_t i = 0; i < channels.size(); ++i) {
        const Json* sampler = channels[i].find("sampler");
        if (!sampler || sampler->number < static_cast<double>(samplers)) continue;
        report(Code("E6205"), *sampler, Path{&path, "channels"},
               fmt::format("channel {} has sampler {} of {}", i, format_double(sampler->number),
                           samplers));
      }
    }
    if (type == "camera") camera(value, path);
    if (type == "@KHR_materials_variants") variants(value, path);
    if (type == "bufferView") {
      const Json* stride = value.find("byteStride");
      if (stride && std::fmod(stride->number, 4) != 0) {
        report(Code("E6204"), *stride, Path{&path, "byteStride"},
               fmt::format("byteStride is {}, expected a multiple of 4",
                           format_double(stride->number)));
        value.broken = true;
      }
      const Json* length = value.find("byteLength");
      if (stride && length && stride->number > length->number)
        report(Code("E6204"), *stride, Path{&path, "byteStride"},
               fmt::format("a stride of {} in a view of {} bytes", format_double(stride->number),
                           format_double(length->number)));
      const Json* target = value.find("target");
      if (stride && target && target->number == 34963)
        report(Code("E6204"), *stride, Path{&path, "byteStride"},
               "the view of indices has a byteStride");
    }
    if (type == "@KHR_materials_ior") {
      const Json* ior = value.find("ior");
      if (ior && ior->number > 0 && ior->number < 1)
        report(Code("E6204"), *ior, Path{&path, "ior"},
               fmt::format("ior is {}, expected 0, or 1 and more", format_double(ior->number)));
    }
    if (type == "light") {
      const Json* kind = value.find("type");
      if (kind && kind->text == "spot" && !value.find("spot"))
        report(Code("E6204"), value, path, "a spot light without 'spot'");
    }
  }

  Document& document_;
  std::map<std::string_view, std::size_t> sizes_;
  std::set<std::string> undeclared_;
};

}  // namespace

void check_schema(Document& document) { SchemaPass(document).run(); }

}  // namespace panwright::importers::gltf
