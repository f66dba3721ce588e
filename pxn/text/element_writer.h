// Writer of elements, attributes and numbers as text.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

#include "base/math.h"
#include "base/text.h"
#include "geometry/tessellate/shape.h"

namespace panwright::pxn {

// Writer of XML from the outside in. Layout is left to formatted().
class ElementWriter {
 public:
  explicit ElementWriter(std::string& out) : out_(out) {}

  // Opens a tag for attributes; child elements or text may follow before close().
  void open(std::string_view tag) {
    finish_tag();
    out_.push_back('<');
    out_ += tag;
    in_tag_ = true;
  }
  void close(std::string_view tag) {
    if (in_tag_) {
      out_ += "/>\n";
    } else {
      out_ += "</";
      out_ += tag;
      out_ += ">\n";
    }
    in_tag_ = false;
  }

  void attribute(std::string_view name, std::string_view value);  // any text
  void attribute(std::string_view name, double value) { numbers(name, std::span(&value, 1)); }
  void attribute(std::string_view name, const Vec3& v) { numbers(name, std::span(&v.x, 3)); }
  void numbers(std::string_view name, std::span<const double> values);

  void number(double value) {
    finish_tag();
    out_ += format_double(value);
    out_.push_back(' ');
  }
  void index(std::uint32_t value) {
    finish_tag();
    out_ += std::to_string(value);
    out_.push_back(' ');
  }
  // Writes an element of numbers.
  void element(std::string_view tag, std::span<const double> values) {
    open(tag);
    for (const double value : values) number(value);
    close(tag);
  }

 private:
  void finish_tag() {
    if (in_tag_) out_.push_back('>');
    in_tag_ = false;
  }

  std::string& out_;
  bool in_tag_ = false;
};

// Write the tag of a shape, and its parameters: attributes first, children after other attributes.
void write_shape_attributes(const geometry::Shape& shape, ElementWriter& out);
void write_shape_children(const geometry::Shape& shape, ElementWriter& out);

}  // namespace panwright::pxn
