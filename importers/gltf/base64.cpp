#include "importers/gltf/base64.h"

#include <array>
#include <cstdint>

namespace panwright::importers::gltf {

namespace {

constexpr std::uint8_t kBad = 255;

constexpr std::array<std::uint8_t, 256> make_digits() {
  std::array<std::uint8_t, 256> digits{};
  for (auto& digit : digits) digit = kBad;
  constexpr std::string_view kAlphabet =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kAlphabet.size(); ++i)
    digits[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
  digits['-'] = 62;  // the alphabet for URLs
  digits['_'] = 63;
  return digits;
}

constexpr std::array<std::uint8_t, 256> kDigits = make_digits();

// Padding may be left out, but not in part.
std::optional<std::string> from_base64(std::string_view text) {
  const std::size_t whole = text.size();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  if (text.size() != whole && (whole % 4 != 0 || whole - text.size() > 2)) return std::nullopt;
  std::string out;
  out.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const std::uint8_t digit = kDigits[static_cast<unsigned char>(c)];
    if (digit == kBad) return std::nullopt;
    bits = bits << 6 | digit;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    out += static_cast<char>(bits >> held & 255);
  }
  return out;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> from_percent(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
    const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) return std::nullopt;
    out += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return out;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

// A type and a subtype, or nothing, and parameters with values (RFC 2397).
bool is_media_type(std::string_view head) {
  const std::string_view type = head.substr(0, head.find(';'));
  if (!type.empty() && type.find('/') == type.npos) return false;
  head.remove_prefix(type.size());
  while (!head.empty()) {
    head.remove_prefix(1);
    const std::string_view parameter = head.substr(0, head.find(';'));
    if (parameter.find('=') == parameter.npos) return false;
    head.remove_prefix(parameter.size());
  }
  return true;
}

}  // namespace

bool is_data_uri(std::string_view uri) { return lower_case(uri.substr(0, 5)) == "data:"; }

std::optional<DataUri> data_of(std::string_view uri) {
  uri.remove_prefix(5);
  const std::size_t comma = uri.find(',');
  if (comma == uri.npos) return std::nullopt;
  std::string_view head = uri.substr(0, comma);
  const bool base64 = head.ends_with(";base64");
  if (base64) head.remove_suffix(7);
  if (!is_media_type(head)) return std::nullopt;
  const std::string_view body = uri.substr(comma + 1);
  const bool escaped = !base64 || body.find('%') != body.npos;
  auto bytes = escaped ? from_percent(body) : from_base64(body);
  if (bytes && base64 && escaped) bytes = from_base64(*bytes);
  if (!bytes) return std::nullopt;
  return DataUri{lower_case(head.substr(0, head.find(';'))), *std::move(bytes)};
}

}  // namespace panwright::importers::gltf
