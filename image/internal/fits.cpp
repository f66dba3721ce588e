// Digital numbers as FITS 4.0: rows from the bottom, big-endian; the record in CONTINUE cards of
// the keyword PANWRGHT.
#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "image/internal/writers.h"

namespace panwright::image {

namespace {

constexpr std::size_t kCard = 80, kBlock = 2880;
constexpr std::string_view kKeyword = "PANWRGHT= '", kContinue = "CONTINUE  '";
constexpr std::size_t kPart = 60;  // characters of a card, before quotes are doubled

void add_card(std::string card, std::string& out) {
  card.resize(kCard, ' ');
  out += card;
}

void pad(std::string& out, char with) {
  out.resize((out.size() + kBlock - 1) / kBlock * kBlock, with);
}

// Text in quotes over as many cards as it takes (FITS 4.0, 4.2.1.2).
void add_text(const std::string& text, std::string& out) {
  for (std::size_t at = 0; at == 0 || at < text.size();) {
    std::string part;
    const bool first = at == 0;
    while (at < text.size() && part.size() < kPart) {
      if (text[at] == '\'') part += '\'';
      part += text[at++];
    }
    add_card(
        fmt::format("{}{}{}'", first ? kKeyword : kContinue, part, at < text.size() ? "&" : ""),
        out);
  }
}

}  // namespace

bool write_fits(AtomicFile& file, const Image& image, DiagnosticLog& log) {
  const bool wide = image.dn_bits > 8;
  std::string head;
  const auto number = [&](const char* name, auto value, const char* comment) {
    add_card(fmt::format("{:<8}= {:>20} / {}", name, value, comment), head);
  };
  number("SIMPLE", "T", "FITS 4.0");
  number("BITPIX", wide ? 16 : 8, "bits of a number");
  number("NAXIS", 2, "");
  number("NAXIS1", image.width, "pixels");
  number("NAXIS2", image.height, "pixels, from the bottom row");
  if (wide) number("BZERO", 32768, "numbers without sign");
  if (wide) number("BSCALE", 1, "");
  number("DATAMAX", (1u << image.dn_bits) - 1, "largest number");
  if (!image.filters.empty())
    add_card(fmt::format("BAYERPAT= '{:<8}'           / from the top row", image.filters), head);
  add_card("LONGSTRN= 'OGIP 1.0'", head);
  for (const auto& [name, value] : image.metadata)
    if (name == kRecordName) add_text(value, head);
  add_card("END", head);
  pad(head, ' ');
  std::string data;
  data.reserve((wide ? 2 : 1) * image.dn.size() + kBlock);
  for (std::uint32_t y = image.height; y-- > 0;)
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::uint16_t dn = image.dn[std::size_t{y} * image.width + x];
      const std::uint16_t stored = wide ? static_cast<std::uint16_t>(dn ^ 0x8000u) : dn;
      if (wide) data += static_cast<char>(stored >> 8);
      data += static_cast<char>(stored);
    }
  pad(data, '\0');
  return file.write(as_bytes(head), log) && file.write(as_bytes(data), log);
}

std::optional<std::string> record_of_fits(std::string_view bytes) {
  if (!bytes.starts_with("SIMPLE  =")) return std::nullopt;
  std::string out;
  bool found = false, goes_on = false;
  for (std::size_t at = 0; at + kCard <= bytes.size(); at += kCard) {
    const std::string_view card = bytes.substr(at, kCard);
    if (card.starts_with("END     ")) break;
    const bool begins = card.starts_with(kKeyword);
    if (!begins && !(goes_on && card.starts_with(kContinue))) {
      goes_on = false;
      continue;
    }
    found = found || begins;
    std::string part;
    for (std::size_t i = kKeyword.size(); i < kCard; ++i) {
      if (card[i] == '\'' && (i + 1 == kCard || card[i + 1] != '\'')) break;
      if (card[i] == '\'') ++i;
      part += card[i];
    }
    goes_on = part.ends_with('&');
    if (goes_on) part.pop_back();
    out += part;
  }
  return found ? std::optional(out) : std::nullopt;
}

bool is_whole_fits(std::string_view bytes) {
  if (!bytes.starts_with("SIMPLE  =")) return false;
  std::size_t size = 1, bits = 0;
  for (std::size_t at = 0; at + kCard <= bytes.size(); at += kCard) {
    const std::string_view card = bytes.substr(at, kCard);
    const auto value = [&] {
      return std::strtoull(std::string(card.substr(10, 20)).c_str(), nullptr, 10);
    };
    if (card.starts_with("BITPIX  =")) bits = value();
    if (card.starts_with("NAXIS1  =") || card.starts_with("NAXIS2  =")) size *= value();
    if (!card.starts_with("END     ")) continue;
    const std::size_t head = (at + kCard + kBlock - 1) / kBlock * kBlock;
    return bytes.size() == head + (size * bits / 8 + kBlock - 1) / kBlock * kBlock;
  }
  return false;
}

}  // namespace panwright::image
