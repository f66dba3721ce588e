#include "importers/internal/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>

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

}  // namespace

bool first_element_is(std::string_view text, std::string_view name) {
  const std::string_view element = first_element(text);
  if (!element.starts_with('<') || !element.substr(1).starts_with(name)) return false;
  const std::string_view rest = element.substr(1 + name.size());
  return !rest.empty() && std::string_view(" \t\r\n/>").find(rest[0]) != std::string_view::npos;
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
  std::string problem = result.description();
  if (!problem.empty()) problem[0] = static_cast<char>(std::tolower(problem[0]));
  context.log.report(
      Code::E6220, context.at(offset, std::min(offset + 1, bytes.size())),
      fmt::format("the XML text is not well-formed: {}; what stands before is read", problem));
  return true;
}

SourceSpan XmlText::span(const char* begin, std::size_t size) const {
  const std::less<> before;
  const char* const first = text_.data();
  if (before(begin, first) || before(first + text_.size(), begin)) return context_->at(0, 0);
  const auto offset = static_cast<std::size_t>(begin - first);
  return context_->at(offset, std::min(offset + size, text_.size()));
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
