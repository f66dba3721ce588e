#include "importers/urdf/internal/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>

namespace panwright::importers::urdf {

namespace {

// What the tree takes for a byte of text at most: an element "<a/>" is 64 bytes.
constexpr std::uint64_t kTreePerByte = 17;

}  // namespace

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

}  // namespace panwright::importers::urdf
