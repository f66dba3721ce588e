#include "pxn/reader/upgrade_text.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text.h"
#include "pxn/pxn.h"
#include "pxn/reader/loader.h"
#include "pxn/text/grammar.h"
#include "pxn/text/markup.h"

namespace panwright::pxn {

namespace {

using schemas::ElementId;

constexpr std::string_view kXmlBlanks = " \t\r\n";

std::size_t lines_in(std::string_view text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// The scene of a small text, to see what becomes of its numbers.
Result<scene::Scene> scene_of(int level, const std::string& node) {
  const MemoryFile file{"small.pxn",
                        fmt::format("<pangu_model ver=\"{}\">{}</pangu_model>", level, node)};
  DiagnosticLog log;
  return read_memory(std::span(&file, 1), {}, log);
}

// The rotation of the one frame of a small text.
std::optional<Quat> frame_rotation(int level, const std::string& frame) {
  const auto scene = scene_of(level, frame);
  if (!scene || scene->frames.size() != 1) return std::nullopt;
  return scene->frames[0].rotation;
}

class Upgrade {
 public:
  Upgrade(const xml::Document& document, const NewPath& new_path, const PathChanged& path_changed)
      : doc_(document), new_path_(new_path), path_changed_(path_changed) {}

  std::string run() {
    out_ = doc_.bytes.substr(0, doc_.elements[0].begin);
    element(0);
    out_ += doc_.bytes.substr(doc_.elements[0].end);
    return std::move(out_);
  }

 private:
  ElementId id(std::uint32_t e) const { return doc_.elements[e].id; }

  // ---- what lies between tags

  // The place of the end tag; of an empty element its end.
  std::uint32_t content_end(std::uint32_t e) const {
    const xml::Element& element = doc_.elements[e];
    if (element.start_tag_end == element.end) return element.end;
    return static_cast<std::uint32_t>(doc_.bytes.rfind("</", element.end - 1));
  }

  // Blanks, comments and text as they are. Where an element was left out before, the blanks around
  // it become those of one place.
  void gap(std::uint32_t begin, std::uint32_t end) {
    std::string_view text = doc_.bytes.substr(begin, end - begin);
    if (left_out_) {
      const std::size_t kept = out_.find_last_not_of(kXmlBlanks) + 1;
      const std::size_t first = std::min(text.find_first_not_of(kXmlBlanks), text.size());
      if (kept == out_.size() ||
          lines_in(std::string_view(out_).substr(kept)) < lines_in(text.substr(0, first)))
        out_.resize(kept);
      else
        text.remove_prefix(first);
      if (text.find_first_not_of(kXmlBlanks) == std::string_view::npos) {
        out_ += text;
        return;
      }
    }
    left_out_ = false;
    out_ += text;
  }

  // What stands in an element, with its children in the words of level 1.
  void content(std::uint32_t e) {
    std::uint32_t at = doc_.elements[e].start_tag_end;
    for (std::uint32_t c = e + 1; c < doc_.elements[e].next; c = doc_.elements[c].next) {
      gap(at, doc_.elements[c].begin);
      element(c);
      at = doc_.elements[c].end;
    }
    gap(at, content_end(e));
  }

  // Nothing of an element but its comments.
  void leave_out(std::uint32_t e) {
    const xml::Element& element = doc_.elements[e];
    xml::Markup markup(doc_.bytes.substr(0, element.end), element.begin);
    bool line = false;
    for (xml::Piece piece = markup.next(); piece.kind != xml::PieceKind::end;
         piece = markup.next()) {
      if (piece.kind == xml::PieceKind::text) line = line || lines_in(piece.bytes) > 0;
      if (piece.kind != xml::PieceKind::comment && piece.kind != xml::PieceKind::instruction)
        continue;
      out_ += line ? "\n" : " ";
      out_ += piece.bytes;
      line = false;
    }
    left_out_ = true;
  }

  // ---- values

  // The words between the tags, references replaced.
  std::string words(std::uint32_t e) const {
    std::string text;
    for (std::uint32_t r = doc_.elements[e].first_run; r < doc_.elements[e + 1].first_run; ++r) {
      const xml::Run& run = doc_.runs[r];
      if ((run.owner & ~xml::kCdata) != e) continue;
      if ((run.owner & xml::kCdata) != 0)
        text += doc_.bytes.substr(run.begin, run.end - run.begin);
      else
        text += xml::decoded(doc_, run.begin, run.end);
    }
    std::string out;
    for (std::size_t i = 0; (i = text.find_first_not_of(kXmlBlanks, i)) != std::string::npos;) {
      const std::size_t end = std::min(text.find_first_of(kXmlBlanks, i), text.size());
      if (!out.empty()) out.push_back(' ');
      out.append(text, i, end - i);
      i = end;
    }
    return out;
  }

  void attribute_from(std::string_view name, std::uint32_t e, ElementId from) {
    if (const std::uint32_t c = child_of(doc_, e, from); c != 0)
      out_ += fmt::format(" {}=\"{}\"", name, words(c));
  }

  // An attribute with its name and quotes as written.
  void copy(const xml::Attribute& a) {
    out_.push_back(' ');
    out_ += doc_.bytes.substr(a.name_begin, a.value_end + 1 - a.name_begin);
  }
  void copy_start_tag(std::uint32_t e) {
    const xml::Element& element = doc_.elements[e];
    out_ += doc_.bytes.substr(element.begin, element.start_tag_end - element.begin);
  }
  void end_tag(std::string_view name) {
    left_out_ = false;
    out_ += fmt::format("</{}>", name);
  }

  // A path as an attribute value, in the file's encoding.
  std::string written_path(const std::string& path) const {
    std::string out;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const auto c = static_cast<unsigned char>(path[i]);
      if (c == '&' || c == '<' || c == '"') {
        out += fmt::format("&#{};", static_cast<unsigned>(c));
      } else if (c < 0x80 || doc_.encoding == Encoding::utf8) {
        out.push_back(path[i]);
      } else {
        // the rest of a sequence of UTF-8 as a reference
        const std::size_t more = c >= 0xf0 ? 3 : c >= 0xe0 ? 2 : 1;
        std::uint32_t character = c & (0x3fu >> more);
        for (std::size_t k = 0; k < more && i + 1 < path.size(); ++k)
          character = character << 6 | (static_cast<unsigned char>(path[++i]) & 0x3fu);
        out += fmt::format("&#{};", character);
      }
    }
    return out;
  }

  // file="…" of an include.
  void path(const xml::Attribute& a) {
    const std::string file =
        to_utf8(xml::decoded(doc_, a.value_begin, a.value_end), Encoding::utf8);
    const auto changed = new_path_(file);
    if (!changed || *changed == file) return copy(a);
    path_changed_(doc_.value_span(a), file, *changed);
    out_ += fmt::format(" file=\"{}\"", written_path(*changed));
  }

  // ---- elements

  void element(std::uint32_t e) {
    left_out_ = false;
    switch (id(e)) {
      case ElementId::pangu_model:
        root(e);
        break;
      case ElementId::transform:
      case ElementId::rotate:
        transform(e);
        break;
      case ElementId::frame_s:
        frame(e);
        break;
      case ElementId::include:
      case ElementId::include_raw:
        include(e);
        break;
      default:
        copy_start_tag(e);
        if (doc_.elements[e].start_tag_end == doc_.elements[e].end) break;
        content(e);
        end_tag(doc_.name(e));
    }
  }

  void root(std::uint32_t e) {
    out_ += "<pangu_model";
    for (std::uint32_t a = doc_.elements[e].first_attribute;
         a < doc_.elements[e + 1].first_attribute; ++a) {
      if (doc_.name(doc_.attributes[a]) == "ver")
        out_ += " ver=\"1\"";
      else
        copy(doc_.attributes[a]);
    }
    out_.push_back('>');
    if (doc_.elements[e].start_tag_end != doc_.elements[e].end) content(e);
    end_tag("pangu_model");
  }

  void transform(std::uint32_t e) {
    out_ += "<transform";
    attribute_from("translate", e, ElementId::translation);
    if (const std::uint32_t c = child_of(doc_, e, ElementId::rotation); c != 0)
      out_ += fmt::format(" rotate=\"{}\"", words(c));
    attribute_from("quat", e, ElementId::quat);
    attribute_from("scale", e, ElementId::scaling);
    out_.push_back('>');
    std::uint32_t at = doc_.elements[e].start_tag_end;
    for (std::uint32_t c = e + 1; c < doc_.elements[e].next; c = doc_.elements[c].next) {
      gap(at, doc_.elements[c].begin);
      if (id(c) == ElementId::child)
        unfold(c);
      else
        leave_out(c);
      at = doc_.elements[c].end;
    }
    gap(at, content_end(e));
    end_tag("transform");
  }

  // The nodes of a <child>, and those of a <group> that is all it holds.
  void unfold(std::uint32_t e) {
    left_out_ = true;
    std::uint32_t at = doc_.elements[e].start_tag_end;
    for (std::uint32_t c = e + 1; c < doc_.elements[e].next; c = doc_.elements[c].next) {
      gap(at, doc_.elements[c].begin);
      if (id(c) == ElementId::group) {
        left_out_ = true;
        if (doc_.elements[c].start_tag_end != doc_.elements[c].end) content(c);
        left_out_ = true;
      } else {
        element(c);
      }
      at = doc_.elements[c].end;
    }
    gap(at, content_end(e));
    left_out_ = true;
  }

  // With forward and up where they give the same rotation, else with its quaternion. What neither
  // gives stays as it is.
  void frame(std::uint32_t e) {
    const auto vector = [&](ElementId holder, ElementId inner) {
      return words(child_of(doc_, child_of(doc_, e, holder), inner));
    };
    const std::string origin = vector(ElementId::origin, ElementId::point);
    const std::string forward = vector(ElementId::forward, ElementId::direction);
    const std::string up = vector(ElementId::up, ElementId::direction);
    const auto rotation = frame_rotation(
        0,
        fmt::format("<frame_s label=\"f\"><origin><vec3>{}</vec3></origin><forward><vec3>{}</vec3>"
                    "</forward><up><vec3>{}</vec3></up><right><vec3>{}</vec3></right></frame_s>",
                    origin, forward, up, vector(ElementId::right, ElementId::direction)));
    std::string attributes;
    if (rotation) {
      const Quat& q = *rotation;
      for (const std::string& way :
           {fmt::format("forward=\"{}\" up=\"{}\"", forward, up),
            fmt::format("quat=\"{} {} {} {}\"", format_double(q.w), format_double(q.x),
                        format_double(q.y), format_double(q.z))}) {
        const auto again = frame_rotation(1, fmt::format("<frame name=\"f\" {}/>", way));
        if (attributes.empty() && again && *again == q) attributes = way;
      }
    }
    if (attributes.empty()) {
      const xml::Element& element = doc_.elements[e];
      out_ += doc_.bytes.substr(element.begin, element.end - element.begin);
      return;
    }
    out_ += "<frame name=";
    const xml::Attribute& label = *find_attribute(doc_, e, "label");
    // with its quotes
    out_ += doc_.bytes.substr(label.value_begin - 1, label.value_end + 2 - label.value_begin);
    out_ += fmt::format(" translate=\"{}\" {}>", origin, attributes);
    leave_out(e);
    end_tag("frame");
  }

  void include(std::uint32_t e) {
    out_ += "<include";
    const bool raw = id(e) == ElementId::include_raw;
    for (std::uint32_t a = doc_.elements[e].first_attribute;
         a < doc_.elements[e + 1].first_attribute; ++a) {
      const xml::Attribute& attribute = doc_.attributes[a];
      if (doc_.name(attribute) == "file")
        path(attribute);
      else if (raw)
        copy(attribute);
    }
    out_.push_back('>');
    leave_out(e);
    end_tag("include");
  }

  const xml::Document& doc_;
  const NewPath& new_path_;
  const PathChanged& path_changed_;
  std::string out_;
  bool left_out_ = false;  // an element or tag, since the last thing that was written
};

}  // namespace

std::string upgraded_text(const xml::Document& document, const NewPath& new_path,
                          const PathChanged& path_changed) {
  return Upgrade(document, new_path, path_changed).run();
}

}  // namespace panwright::pxn
