#include "ephemeris/internal/daf.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <optional>

#include "base/text.h"

namespace panwright::ephemeris {

namespace {

constexpr std::size_t kRecord = 1024;  // bytes
constexpr std::size_t kWord = 8;

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t end = text.find_last_not_of(std::string_view(" \0\r", 3));
  return end == text.npos ? std::string_view() : text.substr(0, end + 1);
}

std::string printable(std::string_view text) {
  std::string out(without_blanks(text));
  for (char& c : out)
    if (c < ' ' || c > '~') c = '?';
  return out;
}

// Kind of files that say "NAIF/DAF" alone: instruments of CK have numbers of -1000 and below.
DafKind sniffed(const std::vector<DafSegment>& segments) {
  for (const DafSegment& each : segments)
    if (each.numbers[0] > -1000 || each.numbers[2] < 2 || each.numbers[2] > 6 ||
        each.numbers[3] < 0 || each.numbers[3] > 1)
      return DafKind::spk;
  return segments.empty() ? DafKind::spk : DafKind::ck;
}

// Sets the kind from the word at the begin of a file; false: another kind.
bool kind_of(std::string_view word, std::size_t integers, Daf& out) {
  word = without_blanks(word);
  if (word == "DAF/SPK")
    out.kind = DafKind::spk;
  else if (word == "DAF/CK")
    out.kind = DafKind::ck;
  else if (word == "DAF/PCK")
    out.kind = DafKind::pck;
  else if (word == "NAIF/DAF")
    out.kind = integers == 5 ? DafKind::pck : sniffed(out.segments);
  else
    return false;
  return integers == (out.kind == DafKind::pck ? 5u : 6u);
}

bool check_times(const DafSegment& segment, std::size_t number, std::string& problem) {
  if (std::isfinite(segment.begin) && std::isfinite(segment.end) && segment.begin <= segment.end)
    return true;
  problem = fmt::format("segment {} {}: its times are no span", number, in_quotes(segment.name));
  return false;
}

// ---- binary files

class BinaryDaf {
 public:
  explicit BinaryDaf(std::span<const std::byte> bytes) : bytes_(bytes) {}

  bool read(Daf& out, std::string& problem) {
    if (bytes_.size() < kRecord) return fail(problem, "the file ends in its first record");
    if (!find_order(problem) || !check_transfer(problem)) return false;
    const std::int32_t integers = integer(12);
    if (integers != 5 && integers != 6)
      return fail(problem, fmt::format("segments have {} integers, expected 5 or 6", integers));
    integers_ = static_cast<std::size_t>(integers);
    // addresses of words count from 1
    records_ = bytes_.size() / kRecord;
    std::size_t visited = 0;
    for (double next = integer(76); next != 0;) {
      const std::size_t record = whole_number(next, records_);
      if (record > records_ || record < 2 || ++visited > records_)
        return fail(problem, fmt::format("the chain of summaries leads to record {}, the file "
                                         "has {}",
                                         next, records_));
      if (!read_summaries(record, out, problem)) return false;
      next = word(record, 0);
    }
    if (!kind_of(text_of(bytes_).substr(0, 8), integers_, out))
      return fail(problem, fmt::format("{} with {} integers a segment is no kernel that is read",
                                       printable(text_of(bytes_).substr(0, 8)), integers_));
    return true;
  }

 private:
  static bool fail(std::string& problem, std::string text) {
    problem = std::move(text);
    return false;
  }

  std::int32_t integer(std::size_t at) const {
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes_.data() + at, sizeof bits);
    return std::bit_cast<std::int32_t>(other_order_ ? __builtin_bswap32(bits) : bits);
  }
  double word(std::size_t record, std::size_t i) const {
    return Doubles(bytes_.data() + (record - 1) * kRecord, kRecord / kWord, other_order_)[i];
  }

  bool find_order(std::string& problem) {
    const std::string_view format = without_blanks(text_of(bytes_).substr(88, 8));
    constexpr bool kBig = std::endian::native == std::endian::big;
    if (format == "LTL-IEEE")
      other_order_ = kBig;
    else if (format == "BIG-IEEE")
      other_order_ = !kBig;
    else if (format.starts_with("VAX"))
      return fail(problem, fmt::format("numbers of the format {} are not read", format));
    else if (integer(8) != 2)  // old files do not name it
      other_order_ = true;
    if (integer(8) != 2)
      return fail(problem, fmt::format("segments have {} doubles, expected 2", integer(8)));
    return true;
  }

  // Bytes that copies in text mode change.
  bool check_transfer(std::string& problem) const {
    constexpr std::string_view kCheck("FTPSTR:\r:\n:\r\n:\r\0:\x81:\x10\xce:ENDFTP", 28);
    const std::string_view found = text_of(bytes_).substr(699, kCheck.size());
    if (!found.starts_with("FTPSTR") || found == kCheck) return true;
    return fail(problem, "a copy in text mode has changed its bytes");
  }

  bool read_summaries(std::size_t record, Daf& out, std::string& problem) {
    const std::size_t size = 2 + (integers_ + 1) / 2;  // words
    const std::size_t most = (kRecord / kWord - 3) / size;
    const std::size_t count = whole_number(word(record, 2), most);
    if (count > most)
      return fail(problem, fmt::format("record {} has {} summaries, at most {} fit", record,
                                       word(record, 2), most));
    for (std::size_t k = 0; k < count; ++k) {
      DafSegment segment;
      const std::size_t number = out.segments.size();
      const std::size_t first = 3 + k * size;
      segment.begin = word(record, first);
      segment.end = word(record, first + 1);
      const std::size_t at = (record - 1) * kRecord + (first + 2) * kWord;
      for (std::size_t i = 0; i + 2 < integers_; ++i) segment.numbers[i] = integer(at + 4 * i);
      const std::int32_t from = integer(at + 4 * (integers_ - 2)),
                         to = integer(at + 4 * (integers_ - 1));
      // the names lie in the record behind
      if (record < records_)
        segment.name =
            printable(text_of(bytes_).substr(record * kRecord + k * size * kWord, size * kWord));
      const std::size_t words = bytes_.size() / kWord;
      if (from < 1 || to < from || static_cast<std::size_t>(to) > words)
        return fail(problem, fmt::format("segment {} {}: its words {} to {} are not in the file, "
                                         "which has {}",
                                         number, in_quotes(segment.name), from, to, words));
      segment.data =
          Doubles(bytes_.data() + (static_cast<std::size_t>(from) - 1) * kWord,
                  static_cast<std::size_t>(to) - static_cast<std::size_t>(from) + 1, other_order_);
      if (!check_times(segment, number, problem)) return false;
      out.segments.push_back(std::move(segment));
    }
    return true;
  }

  std::span<const std::byte> bytes_;
  bool other_order_ = false;
  std::size_t integers_ = 0;
  std::size_t records_ = 0;
};

// ---- transfer files

// Reader of words: quoted texts and plain ones.
class TransferDaf {
 public:
  explicit TransferDaf(std::string_view text) : text_(text) {}

  bool read(Daf& out, std::string& problem) {
    constexpr std::string_view kHead = "DAFETF NAIF DAF ENCODED TRANSFER FILE";
    text_.remove_prefix(kHead.size());
    const auto kind = quoted(), doubles = quoted(), integers = quoted(), name = quoted();
    if (!name || whole(*doubles) != 2 || (whole(*integers) != 5 && whole(*integers) != 6))
      return fail(problem, "the head of the transfer file is damaged");
    integers_ = static_cast<std::size_t>(*whole(*integers));
    for (std::string_view word = plain(); word == "BEGIN_ARRAY"; word = plain())
      if (!read_array(out, problem)) return false;
    if (last_ != "TOTAL_ARRAYS" || plain() != std::to_string(out.segments.size()))
      return fail(problem,
                  fmt::format("the transfer file ends in or behind array {}", out.segments.size()));
    for (std::size_t i = 0; i < out.kept.size(); ++i)
      out.segments[i].data = Doubles(reinterpret_cast<const std::byte*>(out.kept[i].data()),
                                     out.kept[i].size(), false);
    if (!kind_of(*kind, integers_, out))
      return fail(problem,
                  fmt::format("a transfer file of {} is not read", in_quotes(printable(*kind))));
    return true;
  }

 private:
  static bool fail(std::string& problem, std::string text) {
    problem = std::move(text);
    return false;
  }
  static bool is_space(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

  void skip_blanks() {
    std::size_t at = 0;
    while (at < text_.size() && is_space(text_[at])) ++at;
    text_.remove_prefix(at);
  }
  std::optional<std::string_view> quoted() {
    skip_blanks();
    if (!text_.starts_with('\'')) return std::nullopt;
    // a doubled quote of a name stays so
    const std::size_t end = text_.find('\'', 1);
    if (end == text_.npos) return std::nullopt;
    const std::string_view out = text_.substr(1, end - 1);
    text_.remove_prefix(end + 1);
    return out;
  }
  std::string_view plain() {
    skip_blanks();
    std::size_t end = 0;
    while (end < text_.size() && !is_space(text_[end])) ++end;
    last_ = text_.substr(0, end);
    text_.remove_prefix(end);
    return last_;
  }

  static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
  }
  // Whole number of base 16.
  static std::optional<std::int32_t> whole(std::string_view text) {
    const bool negative = text.starts_with('-');
    if (negative) text.remove_prefix(1);
    if (text.empty() || text.size() > 8) return std::nullopt;
    std::int64_t out = 0;
    for (const char c : text) {
      if (digit(c) < 0) return std::nullopt;
      out = 16 * out + digit(c);
    }
    if (negative) out = -out;
    if (out != static_cast<std::int32_t>(out)) return std::nullopt;
    return static_cast<std::int32_t>(out);
  }
  // "1FCC^8": a fraction of base 16 and its exponent.
  static std::optional<double> real(std::string_view text) {
    const std::size_t mark = text.find('^');
    if (mark == text.npos) return std::nullopt;
    std::string_view mantissa = text.substr(0, mark);
    const auto exponent = whole(text.substr(mark + 1));
    const bool negative = mantissa.starts_with('-');
    if (negative) mantissa.remove_prefix(1);
    constexpr int kMostExponent = 300;
    if (!exponent || std::abs(*exponent) > kMostExponent || mantissa.empty() ||
        mantissa.size() > 15)
      return std::nullopt;
    std::int64_t digits = 0;  // 60 bits at most; a double has 53 and the rest is 0
    for (const char c : mantissa) {
      if (digit(c) < 0) return std::nullopt;
      digits = 16 * digits + digit(c);
    }
    const double out = std::ldexp(static_cast<double>(digits),
                                  4 * (*exponent - static_cast<int>(mantissa.size())));
    return negative ? -out : out;
  }

  bool read_array(Daf& out, std::string& problem) {
    constexpr std::size_t kFewestBytes = 5;  // of a number: '0^0'
    const std::size_t number = out.segments.size();
    const auto damaged = [&](const char* what) {
      return fail(problem, fmt::format("array {} of the transfer file: {}", number + 1, what));
    };
    if (plain() != std::to_string(number + 1)) return damaged("its number is another one");
    const auto count = parse_double(plain());
    const std::size_t most = text_.size() / kFewestBytes;
    const std::size_t size = whole_number(count.value_or(-1), most);
    if (size > most) return damaged("it has more numbers than the file");
    DafSegment segment;
    const auto name = quoted(), begin = quoted(), end = quoted();
    if (!end) return damaged("its name or its times are missing");
    segment.name = printable(*name);
    segment.begin = real(*begin).value_or(NAN);
    segment.end = real(*end).value_or(NAN);
    for (std::size_t i = 0; i + 2 < integers_; ++i) {
      const auto text = quoted();
      const auto value = text ? whole(*text) : std::nullopt;
      if (!value) return damaged("a descriptor is no whole number");
      segment.numbers[i] = *value;
    }
    std::vector<double> numbers;
    numbers.reserve(size);
    while (numbers.size() < size) {
      const std::size_t chunk =
          whole_number(parse_double(plain()).value_or(-1), size - numbers.size());
      if (chunk > size || chunk == 0) return damaged("the count of a part is no count");
      for (std::size_t i = 0; i < chunk; ++i) {
        const auto text = quoted();
        const auto value = text ? real(*text) : std::nullopt;
        if (!value) return damaged("a number cannot be read");
        numbers.push_back(*value);
      }
    }
    if (plain() != "END_ARRAY" || plain() != std::to_string(number + 1) ||
        plain() != std::to_string(size))
      return damaged("its end is missing");
    if (!check_times(segment, number, problem)) return false;
    out.kept.push_back(std::move(numbers));
    out.segments.push_back(std::move(segment));
    return true;
  }

  std::string_view text_;
  std::string_view last_;
  std::size_t integers_ = 0;
};

}  // namespace

bool is_daf(std::span<const std::byte> bytes) {
  const std::string_view text = text_of(bytes);
  return text.starts_with("DAF/") || text.starts_with("NAIF/DAF") || text.starts_with("DAFETF");
}

bool read_daf(std::span<const std::byte> bytes, Daf& out, std::string& problem) {
  if (text_of(bytes).starts_with("DAFETF NAIF DAF ENCODED TRANSFER FILE"))
    return TransferDaf(text_of(bytes)).read(out, problem);
  return BinaryDaf(bytes).read(out, problem);
}

}  // namespace panwright::ephemeris
