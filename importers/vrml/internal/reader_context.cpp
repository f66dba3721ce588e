#include "importers/vrml/internal/reader_context.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/file.h"
#include "base/text.h"
#include "importers/internal/gzip.h"
#include "importers/internal/named_file.h"
#include "importers/vrml/internal/characters.h"
#include "importers/vrml/internal/parser.h"

namespace panwright::importers::vrml {

namespace {

constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

bool same_letters(std::string_view text, std::string_view upper) {
  return std::ranges::equal(text, upper, [](char a, char b) {
    return (a >= 'a' && a <= 'z' ? static_cast<char>(a - 'a' + 'A') : a) == b;
  });
}

// The line with the header: the first one, or the first after blank lines and comments that says
// VRML.
std::string_view header_line(std::string_view text) {
  constexpr std::size_t kFurthest = 4096;  // bytes
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const auto line_at = [&](std::size_t at) {
    return text.substr(at, std::min(text.find_first_of("\r\n", at), text.size()) - at);
  };
  const std::string_view first = line_at(0);
  for (std::size_t at = 0; at < std::min(text.size(), kFurthest);) {
    const std::string_view line = line_at(at);
    if (same_letters(line.substr(0, 5), "#VRML")) return line;
    if (line.find_first_not_of(" \t") != line.npos && line[0] != '#') return first;
    at += line.size() + 1;
  }
  return first;
}

// What a header says, and whether it is one of the two that the standards know.
struct Header {
  std::optional<Format> format;
  bool standard = false;
};

Header header_of(std::string_view line) {
  if (line.starts_with("#VRML V2.0 utf8")) return {Format::vrml97, true};
  if (line.starts_with("#VRML V1.0 ascii")) return {Format::vrml1, true};
  // words of the line: extra blanks, "#VRML Draft #2 V2.0 utf8", "#VRML V1.0 utf8"
  std::vector<std::string_view> words;
  for (std::size_t i = 0; (i = line.find_first_not_of(" \t", i)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", i), line.size());
    words.push_back(line.substr(i, end - i));
    i = end;
  }
  if (words.size() < 2 || !same_letters(words[0], "#VRML")) return {};
  for (std::size_t i = 1; i < words.size() && i < 4; ++i) {
    if (same_letters(words[i], "V2.0")) return {Format::vrml97};
    if (same_letters(words[i], "V1.0")) return {Format::vrml1};
  }
  return {};
}

// The first word of a text that is no comment. It is taken off.
std::string_view first_word(std::string_view& text) {
  std::size_t at = 0;
  for (; at < text.size() && !is_word(text[at]); ++at) {
    if (text[at] == '#')
      at = std::min(text.find_first_of("\r\n", at), text.size());
    else if (!is_blank(text[at]))
      return {};
  }
  at = std::min(at, text.size());
  std::size_t end = at;
  while (end < text.size() && is_word(text[end])) ++end;
  const std::string_view word = text.substr(at, end - at);
  text.remove_prefix(end);
  return word;
}

// The version that the first node is of, where it is a node of that one alone and tells it surely.
std::optional<Format> told_by_first_node(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::string_view word = first_word(text);
  if (word == "DEF") {
    first_word(text);
    word = first_word(text);
  }
  if (word == "Shape") return Format::vrml97;
  if (word == "Separator") return Format::vrml1;
  return std::nullopt;
}

// What a text without a header is, by its first word.
std::optional<Format> guessed(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::string_view word = first_word(text);
  if (word == "DEF" || word == "PROTO" || word == "EXTERNPROTO" || spec97(word) != nullptr)
    return Format::vrml97;
  if (spec10(word) != nullptr) return Format::vrml1;
  return std::nullopt;
}

}  // namespace

Document* ReaderContext::open(const InputFile& file) {
  job = file.job;
  return load(file, true);
}

const std::string& ReaderContext::path_of(FileId file) const { return paths_.at(file); }

void ReaderContext::release(Node& node, std::string_view name) {
  constexpr std::size_t kLarge = std::size_t{1} << 20;  // bytes
  for (Field& field : node.fields) {
    Value& value = field.value;
    if (field.name != name || width_of(value.type) == 0) continue;
    const bool whole = value.type == FieldType::mf_int32;
    const std::size_t bytes = value.size * (whole ? sizeof(std::int32_t) : sizeof(double));
    if (bytes < kLarge) continue;
    for (const auto& [path, loaded] : documents_) {
      if (!loaded.document || !loaded.document->arena->release(value.data, bytes)) continue;
      value.data = nullptr;
      value.size = 0;
      break;
    }
  }
}

Document* ReaderContext::load(const InputFile& file, bool top) {
  Loaded& loaded = documents_[file.path];
  const std::string_view text = *file.bytes;
  SourceFile source;
  source.name = file.name;
  source.bytes = file.bytes;
  source.included_at = file.included_at;
  const FileId id = log.sources().add(source);
  paths_[id] = file.path;
  const std::string_view line = header_line(text);
  const auto line_begin = static_cast<std::uint32_t>(line.data() - text.data());
  const SourceSpan where{id, line_begin, line_begin + static_cast<std::uint32_t>(line.size())};
  Header header = header_of(line);
  if (!header.format) {
    if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff")) {
      log.sources().set_encoding(id, Encoding::binary);
      log.report_file(top ? Code("E6101") : Code("W6004"), file.name,
                      "the text is UTF-16; VRML is UTF-8", "convert it, as with iconv");
      return nullptr;
    }
    if (top) header.format = options.assume;
    if (!top) header.format = guessed(text);
    if (header.format && *header.format != Format::vrml97 && *header.format != Format::vrml1)
      header.format.reset();
    if (!header.format) {
      log.report(top ? Code("E6101") : Code("W6004"), where,
                 text.empty()
                     ? "the file is empty"
                     : fmt::format("the first line is {}, and no header of VRML", in_quotes(line)),
                 "'#VRML V2.0 utf8' or '#VRML V1.0 ascii'; --assume=vrml97 reads it as if it were "
                 "there");
      return nullptr;
    }
  }
  const std::size_t mark = text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  const auto told = told_by_first_node(text);
  if (told && told != header.format) {
    header.format = told;
    log.report(
        Code("W6102"), where,
        fmt::format(
            "the header is {}, but the first node exists only in {}; the file is read as that",
            in_quotes(line), *told == Format::vrml97 ? "VRML 97" : "VRML 1.0"));
  } else if (header.standard && line_begin > mark) {
    log.report(Code("W6102"), where, "the header is not the first line");
  }
  if (!header.standard)
    log.report(Code("W6102"), where,
               fmt::format("{}; the file is read as {}",
                           same_letters(line.substr(0, 5), "#VRML")
                               ? fmt::format("the header is {}", in_quotes(line))
                               : std::string("no VRML header"),
                           *header.format == Format::vrml97 ? "VRML 97" : "VRML 1.0"));
  auto document = std::make_unique<Document>();
  document->path = file.path;
  document->file = id;
  document->format = *header.format;
  document->text = file.bytes;
  document->arena = std::make_unique<Arena>(memory_used, options.limits.memory);
  Parser(*this, *document).run();
  loaded.document = std::move(document);
  return loaded.document.get();
}

SharedText ReaderContext::read(std::string_view url, SourceSpan where, bool texture,
                               std::string& path, std::string& problem, Code& code) {
  code = Code("W6004");
  const std::string_view plain = url.substr(0, std::min(url.find('#'), url.size()));
  if (plain.empty()) {
    problem = "an empty name";
    return nullptr;
  }
  if (++files_read_ > options.limits.files) throw OverLimit{"files", where};
  NamedFile found = find_file(files, {.text = plain,
                                      .including = {path_of(where.file)},
                                      .percent_encoded = true,
                                      .part = !texture});
  if (found.outcome == Files::Outcome::too_large) throw OverLimit{"bytes", where};
  if (found.outcome != Files::Outcome::found) {
    if (found.outside) code = Code("W6005");
    problem = found.problem;
    return nullptr;
  }
  if (!found.deviation.empty()) log.report(Code("W6118"), where, found.deviation);
  path = found.path;
  SharedText bytes = std::move(found.bytes);
  const bool known = std::any_of(further_inputs.begin(), further_inputs.end(),
                                 [&](const scene::Input& input) { return input.path == path; });
  if (!known) further_inputs.push_back({path, hash128(as_bytes(*bytes)), bytes->size()});
  return bytes;
}

SharedText ReaderContext::bytes_of(std::span<const std::string_view> urls, SourceSpan where,
                                   std::string* path) {
  std::string problem = "no file is named";
  Code code = Code("W6004");
  for (const std::string_view url : urls)
    if (auto bytes = read(url, where, true, *path, problem, code)) return bytes;
  log.report(code, where, problem);
  return nullptr;
}

Document* ReaderContext::document_at(std::string_view url, SourceSpan where, std::string& problem,
                                     Code& code) {
  // read once, whatever the outcome
  const std::string_view plain = url.substr(0, std::min(url.find('#'), url.size()));
  const auto known_at = [&](const std::string& at) {
    const auto known = documents_.find(at);
    if (known != documents_.end()) problem = fmt::format("{} cannot be used", in_quotes(plain));
    return known;
  };
  if (!plain.empty())
    if (const auto target = resolved(path_of(where.file), plain, true))
      if (const auto known = known_at(*target); known != documents_.end())
        return known->second.document.get();
  std::string path;
  const auto bytes = read(url, where, false, path, problem, code);
  if (!bytes) return nullptr;
  // the name may have been another one of a file that is known
  if (const auto known = known_at(path); known != documents_.end())
    return known->second.document.get();
  const internal::Unpacked unpacked = internal::unpacked(bytes, options.limits.bytes);
  const std::string name = files.display_name(path);
  if (!unpacked.problem.empty()) log.report(Code("E6003"), where, unpacked.problem);
  documents_[path];
  problem = fmt::format("{} is not a VRML file", in_quotes(name));
  if (!unpacked.bytes) return nullptr;
  return load({path, name, unpacked.bytes, where}, false);
}

Document* ReaderContext::inlined(std::span<const std::string_view> urls, SourceSpan where) {
  std::string problem = "no file is named";
  Code code = Code("W6004");
  for (const std::string_view url : urls)
    if (Document* document = document_at(url, where, problem, code)) return document;
  report_missing_part(where, problem, code);
  return nullptr;
}

// A part whose file cannot be used, for the reason that `code` would give a texture.
void ReaderContext::report_missing_part(SourceSpan where, const std::string& problem, Code code) {
  log.report(Code("E6010"), where, fmt::format("part not found: {}", problem),
             code == Code("W6005") ? kRootHint : "");
}

}  // namespace panwright::importers::vrml
