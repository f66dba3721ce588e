// Messages in XML (CCSDS 505.0-B) as those in keyword-value notation.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <pugixml.hpp>

#include "base/text.h"
#include "scenario/internal/ccsds.h"

namespace panwright::scenario {

namespace {

constexpr std::array<std::string_view, 10> kStateNames = {
    "X", "Y", "Z", "X_DOT", "Y_DOT", "Z_DOT", "X_DDOT", "Y_DDOT", "Z_DDOT", "EPOCH"};
constexpr std::array<std::string_view, 4> kQuaternionNames = {"Q1", "Q2", "Q3", "QC"};

constexpr std::size_t kMaxXmlBytes = 64u << 20;  // the tree is 17 times as large

class XmlMessageReader {
 public:
  XmlMessageReader(Input& input, const Grammar& grammar) : input_(input), grammar_(grammar) {}

  Result<Message> read() {
    if (input_.bytes().size() > kMaxXmlBytes) {
      input_.error(Code("E8001"), input_.bytes().substr(0, 1),
                   "messages in XML of over 64 MB are not read",
                   "convert it to keyword-value notation");
      return failed;
    }
    copy_ = input_.bytes();
    const pugi::xml_parse_result parsed = document_.load_buffer_inplace(
        copy_.data(), copy_.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!parsed) {
      const auto offset = std::clamp<std::size_t>(static_cast<std::size_t>(parsed.offset), 0,
                                                  input_.bytes().size());
      input_.error(Code("E8001"), input_.bytes().substr(offset, 1),
                   fmt::format("the XML text is not well-formed: {}", parsed.description()));
      return failed;
    }
    const pugi::xml_node top = message_node();
    if (!top || !read_version(top)) return failed;
    for (const pugi::xml_node& segment : top.child("body").children("segment")) {
      if (!input_.more()) break;
      read_segment(segment);
    }
    if (message_.blocks.empty() && input_.errors() == 0)
      input_.error(Code("E8001"), at(top), "the message has no segment");
    if (input_.errors() > 0) return failed;
    return std::move(message_);
  }

 private:
  // The text of a part of the tree, in the file.
  std::string_view in_file(const char* part, std::size_t size) const {
    const std::less<> before;
    if (before(part, copy_.data()) || before(copy_.data() + copy_.size(), part)) return {};
    return input_.bytes().substr(static_cast<std::size_t>(part - copy_.data()), size);
  }
  std::string_view at(const pugi::xml_node& node) const {
    return in_file(node.name(), std::strlen(node.name()));
  }
  std::string_view value(const pugi::xml_node& node) const {
    const char* const text = node.child_value();
    std::string_view out = in_file(text, std::strlen(text));
    const auto blank = [](char c) { return is_blank_char(c) || c == '\n'; };
    while (!out.empty() && blank(out.front())) out.remove_prefix(1);
    while (!out.empty() && blank(out.back())) out.remove_suffix(1);
    return out;
  }

  // <oem> or <aem>, alone or in <ndm>.
  pugi::xml_node message_node() {
    const pugi::xml_node root = document_.document_element();
    const std::string wanted = grammar_.version_key == "CCSDS_OEM_VERS" ? "oem" : "aem";
    pugi::xml_node top = wanted == root.name() ? root : root.child(wanted.c_str());
    if (!top)
      input_.error(Code("E8001"), at(root),
                   fmt::format("expected <{}>, found <{}>", wanted, root.name()));
    else if (top != root && top.next_sibling(wanted.c_str()))
      input_.error(Code("E8001"), at(top.next_sibling(wanted.c_str())),
                   fmt::format("the file has more than one <{}>", wanted));
    return input_.errors() > 0 ? pugi::xml_node() : top;
  }

  bool read_version(const pugi::xml_node& top) {
    const std::string_view version = top.attribute("version").value();
    for (int each = 1; each <= grammar_.versions; ++each)
      if (version == fmt::format("{}.0", each)) message_.version = each;
    if (message_.version > 0) return true;
    input_.error(Code("E8001"), at(top),
                 fmt::format("version {} is not read, expected 1.0 to {}.0", in_quotes(version),
                             grammar_.versions));
    return false;
  }

  void read_segment(const pugi::xml_node& segment) {
    const pugi::xml_node metadata = segment.child("metadata");
    Block& block = message_.blocks.emplace_back();
    block.begin = at(metadata ? metadata : segment);
    for (const pugi::xml_node& each : metadata.children()) {
      const std::string_view key = at(each);
      if (each.type() != pugi::node_element || key == "COMMENT") continue;
      const Field field{key, value(each)};
      if (std::ranges::find(grammar_.keys, key) == grammar_.keys.end())
        input_.error(Code("E8001"), key, "unknown keyword " + in_quotes(key));
      else if (field.value.empty())
        input_.error(Code("E8001"), key, fmt::format("<{}> is empty", key));
      else if (!block.fields.emplace(key, field).second)
        input_.error(Code("E8001"), key, fmt::format("{} stands twice", key));
    }
    const bool attitudes = grammar_.data_marks;
    for (const pugi::xml_node& state :
         segment.child("data").children(attitudes ? "attitudeState" : "stateVector")) {
      if (!input_.more()) return;
      if (attitudes)
        read_attitude(state.find_child([](const pugi::xml_node& child) {
          return child.type() == pugi::node_element;
        }),
                      block);
      else
        read_state(state, block);
    }
  }

  bool begin_record(const pugi::xml_node& node, Block& block) {
    const pugi::xml_node epoch = node.child("EPOCH");
    if (!epoch) {
      input_.error(Code("E8001"), at(node), fmt::format("<{}> has no EPOCH", node.name()));
      return false;
    }
    block.records.push_back({at(node), value(epoch), block.numbers.size(), 0});
    return true;
  }

  void add_number(const pugi::xml_node& node, std::string_view unit, Block& block) {
    const std::string_view units = node.attribute("units").value();
    if (!units.empty() && !unit.empty() && units != unit)
      input_.error(
          Code("E8001"), at(node),
          fmt::format("units of <{}> are {}, expected {}", node.name(), in_quotes(units), unit));
    block.numbers.push_back(input_.number(value(node), at(node)).value_or(0));
    ++block.records.back().count;
  }

  void read_state(const pugi::xml_node& state, Block& block) {
    if (!begin_record(state, block)) return;
    for (const pugi::xml_node& each : state.children())
      if (each.type() == pugi::node_element &&
          std::ranges::find(kStateNames, std::string_view(each.name())) == kStateNames.end())
        input_.error(Code("E8001"), at(each), fmt::format("unknown element <{}>", each.name()));
    constexpr std::size_t kState = 6, kAll = 9;
    for (std::size_t i = 0; i < kAll; ++i) {
      const pugi::xml_node each = state.child(kStateNames[i].data());
      if (!each && i >= kState) break;
      if (!each) {
        input_.error(Code("E8001"), at(state),
                     fmt::format("<stateVector> has no {}", kStateNames[i]));
        return;
      }
      add_number(each, i < 3 ? "km" : i < kState ? "km/s" : "km/s**2", block);
    }
  }

  // Numbers in the order of the block's QUATERNION_TYPE; rates as zeros, as they are not used.
  void read_attitude(const pugi::xml_node& state, Block& block) {
    if (!state || !begin_record(state, block)) return;
    const Field* const type = block.find("ATTITUDE_TYPE");
    if (type == nullptr || type->value.starts_with("SPIN")) return;
    const std::size_t slash = type->value.find('/');
    const bool quaternion = type->value.starts_with("QUATERNION");
    if (quaternion)
      read_quaternion(state, block);
    else
      read_angles(state, block);
    if (slash == type->value.npos) return;
    const bool four = quaternion && type->value.substr(slash) == "/DERIVATIVE";
    for (std::size_t i = 0; i < (four ? 4 : 3); ++i) {
      block.numbers.push_back(0);
      ++block.records.back().count;
    }
  }

  void read_quaternion(const pugi::xml_node& state, Block& block) {
    const Field* const order = block.find("QUATERNION_TYPE");
    const bool first = order != nullptr && order->value == "FIRST";
    if (order == nullptr && message_.version == 1)
      block.fields.emplace("QUATERNION_TYPE", Field{"QUATERNION_TYPE", "LAST"});
    const pugi::xml_node inner = state.child("quaternion");
    for (std::size_t i = 0; i < 4; ++i) {
      const std::string_view name = kQuaternionNames[first ? (i + 3) % 4 : i];
      const pugi::xml_node each = (inner ? inner : state).child(name.data());
      if (!each) {
        input_.error(Code("E8001"), at(state), fmt::format("<{}> has no {}", state.name(), name));
        return;
      }
      add_number(each, "", block);
    }
  }

  void read_angles(const pugi::xml_node& state, Block& block) {
    const pugi::xml_node inner = state.child("rotationAngles");
    for (std::size_t i = 1; i <= 3; ++i) {
      pugi::xml_node each = inner.child(fmt::format("rotation{}", i).c_str());
      if (!each) each = state.child(fmt::format("ANGLE_{}", i).c_str());
      if (!each) {
        input_.error(Code("E8001"), at(state),
                     fmt::format("<{}> has no angle {}", state.name(), i));
        return;
      }
      add_number(each, "deg", block);
    }
  }

  Input& input_;
  const Grammar& grammar_;
  std::string copy_;
  pugi::xml_document document_;
  Message message_;
};

}  // namespace

Result<Message> read_xml_message(Input& input, const Grammar& grammar) {
  return XmlMessageReader(input, grammar).read();
}

}  // namespace panwright::scenario
