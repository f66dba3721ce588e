#include "pxn/text/grammar.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "base/text.h"

namespace panwright::pxn {

namespace {

using schemas::ElementId;
using schemas::kNoElement;

std::string join(const std::vector<std::string_view>& names, std::string_view last = " or ") {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i)
    out += fmt::format("{}{}", i == 0 ? "" : i + 1 == names.size() ? last : ", ", names[i]);
  return out;
}

bool is_blank(std::string_view text) {
  return text.find_first_not_of(" \t\r\n") == std::string_view::npos;
}

class Checker {
 public:
  Checker(xml::Document& document, const schemas::Language& language, Reporter& reporter)
      : doc_(document), language_(language), reporter_(reporter) {}

  bool run() {
    if (!check_root()) return false;
    for (std::uint32_t i = 0; i < doc_.size();) {
      const xml::Element& e = doc_.elements[i];
      if (e.id == kNoElement) {
        i = e.next;
        continue;
      }
      check_attributes(i);
      check_children(i);
      ++i;
    }
    check_text();
    return true;
  }

 private:
  const schemas::Element& entry(ElementId id) const {
    return language_.elements[static_cast<std::size_t>(id)];
  }
  const schemas::Element& entry(std::uint32_t element) const {
    return entry(doc_.elements[element].id);
  }
  std::string tag(std::uint32_t element) const {
    return to_utf8(doc_.name(element).substr(0, 60), doc_.encoding);
  }
  template <class Compose>
  void report(Code code, SourceSpan where, std::uint32_t element, const Compose& compose) {
    reporter_.report(code, where, doc_, element, compose);
  }

  // ---- root

  bool check_root() {
    const schemas::Element& root = entry(language_.root);
    if (doc_.name(0) != root.name) {
      report(Code("E1107"), doc_.name_span(0), 0, [&]() -> Reporter::Text {
        return {fmt::format("the root element is <{}>, not <{}>", tag(0), root.name),
                near(root.name)};
      });
      return false;
    }
    for (const schemas::Attribute& attribute : root.attributes)
      if (attribute.value.kind == schemas::ValueKind::version && !check_version(attribute))
        return false;
    doc_.elements[0].id = language_.root;
    return true;
  }

  std::string near(std::string_view wanted) const {
    const std::string name = tag(0);
    const std::string_view candidates[] = {wanted};
    return nearest_name(name, candidates) ? fmt::format("did you mean '{}'?", wanted) : "";
  }

  bool check_version(const schemas::Attribute& attribute) {
    const xml::Attribute* given = find_attribute(doc_, 0, attribute.name);
    if (given == nullptr) {
      // reported as missing; read as the newest, so that this is the one error it brings
      level_ = language_.versions.size() - 1;
      return true;
    }
    const std::string value = xml::decoded(doc_, given->value_begin, given->value_end);
    for (std::size_t level = 0; level < language_.versions.size(); ++level) {
      if (language_.versions[level] != value) continue;
      level_ = level;
      return true;
    }
    report(Code("E1107"), doc_.value_span(*given), 0, [&] {
      return Reporter::Text(fmt::format("{}=\"{}\" is not a known version; write {}=\"{}\"",
                                        attribute.name, value, attribute.name,
                                        fmt::join(language_.versions, "\" or \"")));
    });
    return false;
  }

  // ---- attributes

  void check_attributes(std::uint32_t element) {
    const schemas::Element& schema = entry(element);
    const std::uint32_t end = doc_.elements[element + 1].first_attribute;
    for (std::uint32_t i = doc_.elements[element].first_attribute; i < end; ++i) {
      const std::string_view name = doc_.name(doc_.attributes[i]);
      const auto known =
          std::find_if(schema.attributes.begin(), schema.attributes.end(),
                       [&](const schemas::Attribute& attribute) { return attribute.name == name; });
      if (known == schema.attributes.end()) {
        unknown_attribute(element, doc_.attributes[i]);
      } else if (!known->supported || known->level > level_) {
        report(Code("E1106"), doc_.name_span(doc_.attributes[i]), element, [&] {
          return Reporter::Text(
              known->level > level_
                  ? later(known->name, known->level)
                  : fmt::format("'{}' of <{}> is not supported yet; it is left out", known->name,
                                schema.name));
        });
      }
    }
    for (const schemas::Attribute& attribute : schema.attributes) {
      if (!attribute.required || attribute.level > level_ ||
          find_attribute(doc_, element, attribute.name) != nullptr)
        continue;
      report(Code("E1103"), doc_.name_span(element), element, [&] {
        return Reporter::Text(
            fmt::format("the attribute '{}' of <{}> is missing", attribute.name, schema.name),
            attribute.value.kind == schemas::ValueKind::version
                ? fmt::format("write {}=\"{}\"", attribute.name,
                              fmt::join(language_.versions, "\" or \""))
                : std::string());
      });
    }
  }

  void unknown_attribute(std::uint32_t element, const xml::Attribute& attribute) {
    report(Code("E1102"), doc_.name_span(attribute), element, [&]() -> Reporter::Text {
      const schemas::Element& schema = entry(element);
      const std::string name = to_utf8(doc_.name(attribute).substr(0, 60), doc_.encoding);
      std::vector<std::string_view> here;
      for (const schemas::Attribute& known : schema.attributes)
        if (known.level <= level_) here.push_back(known.name);
      const std::string takes =
          here.empty() ? "it has no attributes" : fmt::format("it has {}", join(here, " and "));
      std::string hint;
      if (const auto near_here = nearest_name(name, here)) {
        hint = fmt::format("did you mean '{}'?", *near_here);
      } else {
        std::vector<std::string_view> owners;
        for (const schemas::Element& other : language_.elements)
          for (const schemas::Attribute& known : other.attributes)
            if (known.name == name &&
                std::find(owners.begin(), owners.end(), other.name) == owners.end())
              owners.push_back(other.name);
        for (const schemas::Slot& slot : schema.slots)
          for (const ElementId child : slot.elements)
            if (entry(child).name == name)
              hint = fmt::format("'{}' is an element inside <{}>", name, schema.name);
        if (!owners.empty()) hint = fmt::format("'{}' belongs to <{}>", name, join_tags(owners));
      }
      return {fmt::format("unknown attribute '{1}' of <{0}>; {2}", schema.name, name, takes), hint};
    });
  }

  static std::string join_tags(const std::vector<std::string_view>& names) {
    return fmt::format("{}", fmt::join(names, "> or <"));
  }

  std::string later(std::string_view name, std::size_t level) const {
    return fmt::format("'{}' belongs to level {} of the language, and this file says {}", name,
                       level, language_.versions[level_]);
  }

  // ---- children

  void check_children(std::uint32_t element) {
    const schemas::Element& schema = entry(element);
    counts_.assign(schema.slots.size(), 0);
    strangers_ = 0;
    const std::uint32_t end = doc_.elements[element].next;
    for (std::uint32_t child = element + 1; child < end; child = doc_.elements[child].next)
      check_child(element, child);
    // a misspelt child is one problem, not two
    if (strangers_ > 0) return;
    for (std::size_t s = 0; s < schema.slots.size(); ++s)
      if (counts_[s] < schema.slots[s].min) missing_child(element, schema.slots[s], counts_[s]);
    for (const schemas::Rule& rule : schema.rules) check_rule(element, rule);
  }

  void check_child(std::uint32_t element, std::uint32_t child) {
    const schemas::Element& schema = entry(element);
    const std::string_view name = doc_.name(child);
    // of those that share a tag, the one of the highest level up to the file's
    std::size_t place = schema.slots.size();
    ElementId found = kNoElement;
    for (std::size_t s = 0; s < schema.slots.size(); ++s)
      for (const ElementId id : schema.slots[s].elements) {
        if (entry(id).name != name) continue;
        const bool better = found == kNoElement ||
                            (entry(id).level <= level_ &&
                             (entry(found).level > level_ || entry(id).level > entry(found).level));
        if (!better) continue;
        found = id;
        place = s;
      }
    if (found != kNoElement) {
      const schemas::Slot& slot = schema.slots[place];
      const schemas::Element& known = entry(found);
      ++counts_[place];
      if (!known.supported || known.level > level_) {
        report(Code("E1106"), doc_.name_span(child), child, [&] {
          return Reporter::Text(
              known.level > level_
                  ? later(known.name, known.level)
                  : fmt::format("<{}> is not supported yet; it is left out", name));
        });
      } else if (slot.max != 0 && counts_[place] > slot.max) {
        too_many(element, child, slot);
      } else {
        doc_.elements[child].id = found;
      }
      return;
    }
    ++strangers_;
    unknown_child(element, child);
  }

  void too_many(std::uint32_t element, std::uint32_t child, const schemas::Slot& slot) {
    report(Code("E1104"), doc_.name_span(child), child, [&]() -> Reporter::Text {
      const std::string what =
          slot.label.empty() ? fmt::format("<{}>", tag(child)) : std::string(slot.label);
      return {
          fmt::format("<{}> takes at most one {}; this one is left out", entry(element).name, what),
          std::string(slot.hint)};
    });
  }

  // note: elements of different levels may share a name
  static void add_name(std::vector<std::string_view>& names, std::string_view name) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }

  std::vector<std::string_view> names_in(const schemas::Element& schema) const {
    std::vector<std::string_view> names;
    for (const schemas::Slot& slot : schema.slots)
      for (const ElementId id : slot.elements)
        if (entry(id).level <= level_ && entry(id).supported) add_name(names, entry(id).name);
    return names;
  }

  // "'diffuse' belongs in <material>", for a name that stands in the wrong place.
  std::string belongs(std::string_view name) const {
    std::vector<std::string_view> owners;
    for (const schemas::Element& other : language_.elements)
      for (const schemas::Slot& slot : other.slots)
        for (const ElementId id : slot.elements)
          if (entry(id).name == name &&
              std::find(owners.begin(), owners.end(), other.name) == owners.end())
            owners.push_back(other.name);
    if (owners.empty()) return {};
    return fmt::format("'{}' belongs in <{}>", name, join_tags(owners));
  }

  // Elements of scene formats that a model does not hold.
  static std::string elsewhere(std::string_view name) {
    constexpr std::string_view kLights[] = {"light", "lights", "directional_light", "pointlight",
                                            "spotlight"};
    constexpr std::pair<std::string_view, std::string_view> kElsewhere[] = {
        {"camera", "--camera \"X Y Z\""},
        {"view", "--camera \"X Y Z\""},
        {"viewpoint", "--camera \"X Y Z\""},
        {"sensor", "--camera \"X Y Z\""}};
    std::string plain(name);
    for (char& c : plain)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (std::ranges::find(kLights, plain) != std::end(kLights))
      return "a lamp on a node is <lamp>, the Sun that of <scene>, or of `panwright render --sun "
             "\"X Y Z\"`";
    for (const auto& [other, option] : kElsewhere)
      if (plain == other)
        return fmt::format(
            "a file holds a model alone: `panwright render` takes {}{}", option,
            option.starts_with("--camera")
                ? ", and --camera-frame NAME places the camera in a <frame name=\"NAME\">"
                : "");
    return {};
  }

  void unknown_child(std::uint32_t element, std::uint32_t child) {
    report(Code("E1101"), doc_.name_span(child), child, [&]() -> Reporter::Text {
      const schemas::Element& schema = entry(element);
      const std::string name = tag(child);
      const std::vector<std::string_view> here = names_in(schema);
      std::string message;
      if (here.empty())
        message = fmt::format("<{}> takes no elements, found '{}'", schema.name, name);
      else
        message = fmt::format("unknown element '{1}' in <{0}>, expected {2}", schema.name, name,
                              join(here));
      std::string hint = belongs(name);
      if (hint.empty()) hint = elsewhere(name);
      if (hint.empty()) {
        std::vector<std::string_view> anywhere;
        for (const schemas::Element& other : language_.elements) anywhere.push_back(other.name);
        if (const auto near_here = nearest_name(name, here))
          hint = fmt::format("did you mean '{}'?", *near_here);
        else if (const auto near_anywhere = nearest_name(name, anywhere))
          hint = fmt::format("did you mean '{}'? {}", *near_anywhere, belongs(*near_anywhere));
      }
      return {message, hint};
    });
  }

  void missing_child(std::uint32_t element, const schemas::Slot& slot, std::uint32_t count) {
    report(Code("E1103"), doc_.name_span(element), element, [&] {
      std::vector<std::string_view> names;
      for (const ElementId id : slot.elements)
        if (entry(id).supported && entry(id).level <= level_) add_name(names, entry(id).name);
      const std::string what =
          slot.elements.size() == 1 ? fmt::format("<{}>", names.empty() ? "" : names[0])
          : slot.label.empty() ? fmt::format("<{}>", join_tags(names))
                                    : fmt::format("a {}: {}", slot.label, join(names));
      const std::string many = slot.min > 1 ? fmt::format("{} of ", slot.min - count) : "";
      return Reporter::Text(fmt::format("<{}> needs {}{}", entry(element).name, many, what));
    });
  }

  // ---- rules

  bool present(std::uint32_t element, std::string_view member) const {
    if (member.starts_with('@')) return find_attribute(doc_, element, member.substr(1)) != nullptr;
    const std::uint32_t end = doc_.elements[element].next;
    for (std::uint32_t c = element + 1; c < end; c = doc_.elements[c].next)
      if (doc_.elements[c].id != kNoElement && doc_.name(c) == member) return true;
    return false;
  }

  void check_rule(std::uint32_t element, const schemas::Rule& rule) {
    using schemas::RuleKind;
    std::vector<std::string_view> there;
    std::vector<std::string_view> missing;
    for (const std::string_view member : rule.members)
      (present(element, member) ? there : missing).push_back(member);
    const std::vector<std::string_view> all(rule.members.begin(), rule.members.end());
    std::string broken;
    switch (rule.kind) {
      case RuleKind::exclusive:
        if (there.size() > 1)
          broken = fmt::format("takes at most one of {}, not {}", join(all), join(there, " and "));
        break;
      case RuleKind::one_of:
        if (there.size() != 1)
          broken = fmt::format("needs exactly one of {}{}", join(all),
                               there.empty() ? "" : fmt::format(", not {}", join(there, " and ")));
        break;
      case RuleKind::any_of:
        if (there.empty()) broken = fmt::format("needs at least one of {}", join(all));
        break;
      case RuleKind::together:
        if (!there.empty() && !missing.empty())
          broken = fmt::format("has {} without {}; they go together", join(there, " and "),
                               join(missing, " and "));
        break;
      case RuleKind::requires_others:
        if (!there.empty() && there[0] == rule.members[0] && !missing.empty())
          broken = fmt::format("has {}, which needs {}", there[0], join(missing, " and "));
        break;
    }
    if (broken.empty()) return;
    report(Code("E1108"), doc_.name_span(element), element,
           [&] { return Reporter::Text(fmt::format("<{}> {}", entry(element).name, broken)); });
  }

  // ---- text

  void check_text() {
    std::uint32_t last = 0xffffffffu;
    for (const xml::Run& run : doc_.runs) {
      const std::uint32_t owner = run.owner & ~xml::kCdata;
      const ElementId id = doc_.elements[owner].id;
      if (id == kNoElement || owner == last) continue;
      if (entry(id).text.kind != schemas::ValueKind::none) continue;
      const std::string_view text = doc_.bytes.substr(run.begin, run.end - run.begin);
      if (is_blank(text)) continue;
      last = owner;
      const std::size_t lead = text.find_first_not_of(" \t\r\n");
      const std::size_t tail = text.find_last_not_of(" \t\r\n") + 1;
      report(Code("E1105"),
             doc_.span(run.begin + static_cast<std::uint32_t>(lead),
                       run.begin + static_cast<std::uint32_t>(tail)),
             owner, [&] {
               return Reporter::Text(fmt::format(
                   "<{}> takes no text, found {}", entry(id).name,
                   in_quotes(to_utf8(text.substr(lead, std::min<std::size_t>(tail - lead, 256)),
                                     doc_.encoding))));
             });
    }
  }

  xml::Document& doc_;
  const schemas::Language& language_;
  Reporter& reporter_;
  std::size_t level_ = 0;
  std::vector<std::uint32_t> counts_;  // of children in each slot of the element at hand
  std::uint32_t strangers_ = 0;        // its children that fit no slot
};

}  // namespace

bool check_grammar(xml::Document& document, const schemas::Language& language, Reporter& reporter) {
  return !document.empty() && Checker(document, language, reporter).run();
}

const xml::Attribute* find_attribute(const xml::Document& document, std::uint32_t element,
                                     std::string_view name) {
  const std::uint32_t end = document.elements[element + 1].first_attribute;
  for (std::uint32_t i = document.elements[element].first_attribute; i < end; ++i)
    if (document.name(document.attributes[i]) == name) return &document.attributes[i];
  return nullptr;
}

}  // namespace panwright::pxn
