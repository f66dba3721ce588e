#include "importers/internal/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>

#include "base/text.h"
#include "importers/internal/xml_encoding.h"

namespace panwright::importers {

namespace {

// What the tree takes for a byte of text at most: an element "<a/>" is 64 bytes.
constexpr std::uint64_t kTreePerByte = 17;

// The rest of a text after what may stand before its first element.
std::string_view first_element(std::string_view text) {
  for (;;) {
    const std::size_t at = text.find_first_not_of(" \t\r\n");
    if (at == text.npos) return {};
    text.remove_prefix(at);
    std::string_view end;
    if (text.starts_with("<?"))
      end = "?>";
    else if (text.starts_with("<!--"))
      end = "-->";
    else if (text.starts_with("<!"))
      end = ">";
    else
      return text;
    const std::size_t stop = text.find(end, 2);
    if (stop == text.npos) return {};
    text.remove_prefix(stop + end.size());
  }
}

std::string not_well_formed(const pugi::xml_parse_result& result) {
  std::string problem = result.description();
  if (!problem.empty()) problem[0] = static_cast<char>(std::tolower(problem[0]));
  return fmt::format("the XML text is not well-formed: {}; the text before is read", problem);
}

}  // namespace

bool first_element_is(std::string_view text, std::string_view name) {
  const std::string_view element = first_element(text);
  if (!element.starts_with('<') || !element.substr(1).starts_with(name)) return false;
  const std::string_view rest = element.substr(1 + name.size());
  return !rest.empty() && std::string_view(" \t\r\n/>").find(rest[0]) != std::string_view::npos;
}

pugi::xml_node XmlText::include(pugi::xml_node element, const std::string& path,
                                const SharedText& given, SourceSpan where,
                                std::initializer_list<std::string_view> names) {
  pugi::xml_node parent = element.parent();
  const auto without = [&] {
    const pugi::xml_node next = element.next_sibling();
    parent.remove_child(element);
    return next;
  };
  const internal::Recoded text = internal::xml_in_utf8(given);
  const SharedText& bytes = text.bytes;
  if (!context_->charge((kTreePerByte + 1) * bytes->size())) return without();
  const FileId file = context_->log.sources().add(
      {context_->files.display_name(path), bytes, Encoding::utf8, where});
  if (!text.deviation.empty()) context_->log.report(Code("W6221"), {file, 0, 0}, text.deviation);
  const auto place = [&](std::size_t begin, std::size_t size) {
    return SourceSpan{file, static_cast<std::uint32_t>(std::min(begin, bytes->size())),
                      static_cast<std::uint32_t>(std::min(begin + size, bytes->size()))};
  };
  const pugi::xml_parse_result result =
      element.append_buffer(bytes->data(), bytes->size(), pugi::parse_default, pugi::encoding_utf8);
  if (!result)
    context_->log.report(
        Code("E6220"),
        place(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), 1),
        not_well_formed(result));
  const pugi::xml_node top = element.find_child(
      [](const pugi::xml_node& child) { return child.type() == pugi::node_element; });
  if (!top) return without();
  // where its memory begins follows from where its first element's name does
  const std::string_view rest = first_element(*bytes);
  const auto offset = static_cast<std::size_t>(rest.data() - bytes->data()) + 1;
  const char* ignored = nullptr;
  included_[top.name() - offset] = {bytes->size(), file, path, piece_at(element.name(), ignored)};
  if (std::ranges::find(names, std::string_view(top.name())) == names.end()) {
    context_->log.report(Code("E6220"), at(top),
                         fmt::format("unexpected element {}, expected {}; the file is not read",
                                     in_quotes(top.name()), fmt::join(names, " or ")));
    return without();
  }
  pugi::xml_node first;
  for (pugi::xml_node child = top.first_child(), next; child; child = next) {
    next = child.next_sibling();
    const pugi::xml_node moved = parent.insert_move_before(child, element);
    if (!first) first = moved;
  }
  const pugi::xml_node next = without();
  return first ? first : next;
}

bool XmlText::parse(meshes::ReaderContext& context) {
  context_ = &context;
  const std::string_view bytes = *context.file.bytes;
  if (!context.charge(kTreePerByte * bytes.size())) return false;
  text_ = bytes;
  const pugi::xml_parse_result result = document_.load_buffer_inplace(
      text_.data(), text_.size(), pugi::parse_default, pugi::encoding_utf8);
  if (result) return true;
  const std::size_t offset =
      std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), bytes.size());
  context.log.report(Code("E6220"), context.at(offset, std::min(offset + 1, bytes.size())),
                     not_well_formed(result));
  return true;
}

const XmlText::Piece* XmlText::piece_at(const char* place, const char*& begin) const {
  const std::less<> before;
  begin = text_.data();
  if (!before(place, begin) && !before(begin + text_.size(), place)) return nullptr;
  const auto next = included_.upper_bound(place);
  if (next == included_.begin()) return nullptr;
  const auto& [first, piece] = *std::prev(next);
  if (before(first + piece.size, place)) return nullptr;
  begin = first;
  return &piece;
}

bool XmlText::is_within(const pugi::xml_node& element, const std::string& path) const {
  const char* begin = nullptr;
  for (const Piece* piece = piece_at(element.name(), begin); piece; piece = piece->around)
    if (piece->path == path) return true;
  return path == context_->file.path;
}

const std::string& XmlText::path_of(const pugi::xml_node& element) const {
  const char* begin = nullptr;
  const Piece* const piece = piece_at(element.name(), begin);
  return piece ? piece->path : context_->file.path;
}

SourceSpan XmlText::span(const char* place, std::size_t size) const {
  const char* begin = nullptr;
  const Piece* const piece = piece_at(place, begin);
  const std::less<> before;
  if (!piece && (before(place, begin) || before(begin + text_.size(), place)))
    return context_->at(0, 0);
  const auto offset = static_cast<std::size_t>(place - begin);
  if (!piece) return context_->at(offset, std::min(offset + size, text_.size()));
  return {piece->file, static_cast<std::uint32_t>(offset),
          static_cast<std::uint32_t>(std::min(offset + size, piece->size))};
}

SourceSpan XmlText::at(const pugi::xml_node& element) const {
  const std::string_view name = element.name();
  return span(name.data(), name.size());
}

SourceSpan XmlText::at(const pugi::xml_attribute& attribute) const {
  const std::string_view value = attribute.value();
  if (!value.empty()) return span(value.data(), value.size());
  const std::string_view name = attribute.name();
  return span(name.data(), name.size());
}

}  // namespace panwright::importers
