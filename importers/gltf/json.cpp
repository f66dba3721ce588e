#include "importers/gltf/json.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/text.h"

namespace panwright::importers::gltf {

namespace {

// Tells the handler how far the parser has read.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, const char** seen) : at_(at), seen_(seen) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    *seen_ = ++at_;
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** seen_;
};

// Builds the tree; nlohmann's parser calls it for each token.
class Builder {
 public:
  Builder(const char* begin, const char** seen, std::uint32_t depth, std::uint64_t values,
          ParsedJson& out)
      : begin_(begin), seen_(seen), depth_(depth), left_(values), out_(out) {}

  bool null() { return add(Json::Kind::null) != nullptr; }
  bool boolean(bool value) {
    Json* json = add(Json::Kind::boolean);
    if (json) json->number = value;
    return json;
  }
  bool number_integer(std::int64_t value) { return number(static_cast<double>(value), true); }
  bool number_unsigned(std::uint64_t value) { return number(static_cast<double>(value), true); }
  bool number_float(double value, const std::string&) {
    return number(value, value == std::floor(value));
  }
  bool string(std::string& value) {
    Json* json = add(Json::Kind::string);
    if (json) json->text = std::move(value);
    return json;
  }
  template <class Binary>
  bool binary(Binary&) {
    return false;
  }
  bool start_object(std::size_t) { return open(Json::Kind::object); }
  bool start_array(std::size_t) { return open(Json::Kind::array); }
  bool key(std::string& value) {
    open_.back()->keys.push_back(std::move(value));
    return true;
  }
  bool end_array() {
    open_.pop_back();
    return true;
  }
  bool end_object() {
    drop_repeated(*open_.back());
    open_.pop_back();
    return true;
  }
  template <class Exception>
  bool parse_error(std::size_t position, const std::string& token, const Exception& error) {
    const bool overflow = error.id == 406;
    out_.problem = JsonProblem{
        position > 0 ? position - 1 : 0,
        overflow ? fmt::format("the number {} is too large", in_quotes(token))
                 : fmt::format("the JSON is truncated at {}",
                               token.empty() ? std::string("its end") : in_quotes(token))};
    return false;
  }

 private:
  std::uint32_t here() const {
    return static_cast<std::uint32_t>(std::max<std::ptrdiff_t>(*seen_ - begin_ - 1, 0));
  }

  bool stop(std::string message) {
    out_.problem = JsonProblem{here(), std::move(message)};
    return false;
  }

  Json* add(Json::Kind kind) {
    if (left_-- == 0) {
      stop("the JSON holds more values than memory is allowed for");
      return nullptr;
    }
    Json* json = open_.empty() ? &out_.root : &open_.back()->items.emplace_back();
    json->kind = kind;
    json->offset = here();
    return json;
  }

  bool number(double value, bool integral) {
    Json* json = add(Json::Kind::number);
    if (!json) return false;
    json->number = value;
    json->integral = integral;
    return true;
  }

  bool open(Json::Kind kind) {
    if (open_.size() >= depth_)
      return stop(fmt::format("JSON is nested deeper than {} levels", depth_));
    Json* json = add(kind);
    if (json) open_.push_back(json);
    return json;
  }

  void drop_repeated(Json& object) {
    const std::size_t count = object.keys.size();
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return object.keys[a] < object.keys[b]; });
    std::vector<std::size_t> earlier;
    for (std::size_t i = 0; i + 1 < count; ++i)
      if (object.keys[order[i]] == object.keys[order[i + 1]]) earlier.push_back(order[i]);
    if (earlier.empty()) return;
    std::vector<bool> drop(count);
    for (const std::size_t i : earlier) {
      drop[i] = true;
      out_.repeated.push_back(
          {object.items[i].offset, fmt::format("{} is repeated in one object; the last one is used",
                                               in_quotes(object.keys[i]))});
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (drop[i]) continue;
      if (kept != i) {
        object.keys[kept] = std::move(object.keys[i]);
        object.items[kept] = std::move(object.items[i]);
      }
      ++kept;
    }
    object.keys.resize(kept);
    object.items.resize(kept);
  }

  const char* begin_;
  const char** seen_;
  std::uint32_t depth_;
  std::uint64_t left_;
  ParsedJson& out_;
  std::vector<Json*> open_;
};

}  // namespace

const Json* Json::find(std::string_view key) const {
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (keys[i] == key) return &items[i];
  return nullptr;
}

Json* Json::find(std::string_view key) {
  return const_cast<Json*>(static_cast<const Json*>(this)->find(key));
}

void Json::erase(std::string_view key) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i] != key) continue;
    keys.erase(keys.begin() + static_cast<std::ptrdiff_t>(i));
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
    return;
  }
}

const std::vector<Json>& Json::list(std::string_view key) const {
  static const std::vector<Json> none;
  const Json* found = find(key);
  return found && found->is(Kind::array) ? found->items : none;
}

ParsedJson parsed_json(std::string_view text, std::uint32_t depth, std::uint64_t values) {
  ParsedJson out;
  const char* seen = text.data();
  Builder builder(text.data(), &seen, depth, values, out);
  const bool whole =
      nlohmann::json::sax_parse(CountingIterator(text.data(), &seen),
                                CountingIterator(text.data() + text.size(), &seen), &builder);
  if (!whole && !out.problem) out.problem = JsonProblem{0, "this is not JSON"};
  return out;
}

void append_json_string(std::string_view value, std::string& text) {
  text += '"';
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else {
      text += c;
    }
  }
  text += '"';
}

void append_json(const Json& value, std::string& text) {
  switch (value.kind) {
    case Json::Kind::null:
      text += "null";
      break;
    case Json::Kind::boolean:
      text += value.number != 0 ? "true" : "false";
      break;
    case Json::Kind::number:
      text += value.integral && std::fabs(value.number) < 0x1p53
                  ? fmt::format("{}", static_cast<std::int64_t>(value.number))
                  : format_double(value.number);
      break;
    case Json::Kind::string:
      append_json_string(value.text, text);
      break;
    case Json::Kind::array:
      text += '[';
      for (std::size_t i = 0; i < value.items.size(); ++i) {
        if (i > 0) text += ',';
        append_json(value.items[i], text);
      }
      text += ']';
      break;
    case Json::Kind::object:
      text += '{';
      for (std::size_t i = 0; i < value.items.size(); ++i) {
        if (value.keys[i] == "extras") continue;
        if (text.back() != '{') text += ',';
        append_json_string(value.keys[i], text);
        text += ':';
        append_json(value.items[i], text);
      }
      text += '}';
      break;
  }
}

}  // namespace panwright::importers::gltf
