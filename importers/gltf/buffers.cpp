#include <fmt/core.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/text.h"
#include "importers/gltf/base64.h"
#include "importers/gltf/document.h"
#include "importers/gltf/read.h"

namespace panwright::importers::gltf {

namespace {

// 2^53: a JSON number beyond it is not exact, and no file is that long.
constexpr double kMostBytes = 0x1p53;

std::uint64_t size_of(const Json& object, std::string_view key, std::uint64_t otherwise) {
  const Json* found = object.find(key);
  if (!found) return otherwise;
  return found->number < kMostBytes ? static_cast<std::uint64_t>(found->number)
                                    : static_cast<std::uint64_t>(kMostBytes);
}

const Json* extension_of(const Json& object, std::string_view a, std::string_view b) {
  const Json* all = object.find("extensions");
  if (!all) return nullptr;
  const Json* found = all->find(a);
  return found ? found : all->find(b);
}

class BufferLoader {
 public:
  explicit BufferLoader(Document& document) : d_(document) {}

  void run() {
    const std::vector<Json>& buffers = d_.root.list("buffers");
    d_.buffers.resize(buffers.size());
    d_.file_bytes = d_.file.bytes->size();
    for (std::size_t i = 0; i < buffers.size(); ++i) load(i, buffers[i]);
    const std::vector<Json>& views = d_.root.list("bufferViews");
    d_.views.resize(views.size());
    for (std::size_t i = 0; i < views.size(); ++i) find_view(i, views[i]);
    decode();
  }

 private:
  struct Packed {
    std::size_t view;
    std::span<const std::byte> bytes;
    std::size_t stride;
    std::size_t count;
    char mode;    // A T I
    char filter;  // N O Q E
    bool good = false;
  };

  void load(std::size_t index, const Json& json) {
    Buffer& buffer = d_.buffers[index];
    const std::string at = pointer("buffers", index);
    buffer.declared = size_of(json, "byteLength", 0);
    const Json* fallback = extension_of(json, "EXT_meshopt_compression", "KHR_meshopt_compression");
    const Json* uri = json.find("uri");
    if (!uri) {
      if (index == 0 && d_.has_binary)
        buffer.bytes = as_bytes(d_.binary);
      else if (index == 0 && !d_.text && !fallback)
        d_.report(Code("E6206"), &json, at,
                  "the container has no BIN chunk that it could refer to");
      else
        return;
    } else if (!(is_data_uri(uri->text) ? load_data(*uri, at, buffer)
                                        : load_file(*uri, at, buffer))) {
      return;
    }
    const std::uint64_t there = buffer.bytes.size();
    if (there < buffer.declared)
      d_.report(Code("E6206"), &json, at,
                fmt::format("{} bytes are declared, found {}", buffer.declared, there));
    else if (there > buffer.declared + 3 && !json.broken)
      d_.report(Code("W6215"), &json, at,
                fmt::format("found {} bytes, {} are declared", there, buffer.declared));
    buffer.bytes = buffer.bytes.first(std::min(there, buffer.declared));
  }

  bool load_data(const Json& uri, const std::string& at, Buffer& buffer) {
    auto data = data_of(uri.text);
    if (!data) {
      d_.report(Code("E6206"), &uri, at + "/uri", "the data URI is damaged");
      return false;
    }
    if (data->media_type != "application/octet-stream" &&
        data->media_type != "application/gltf-buffer")
      d_.report(
          Code("W6215"), &uri, at + "/uri",
          fmt::format("the media type {} is not that of a buffer", in_quotes(data->media_type)));
    buffer.owner = std::make_shared<const std::string>(std::move(data->bytes));
    buffer.bytes = as_bytes(*buffer.owner);
    return true;
  }

  bool load_file(const Json& uri, const std::string& at, Buffer& buffer) {
    const auto known = loaded_.find(uri.text);
    if (known != loaded_.end()) {
      buffer.owner = known->second;
    } else {
      if (++files_ > d_.options.limits.files) {
        d_.report(Code("E6002"), &uri, at,
                  fmt::format("more than {} files", d_.options.limits.files));
        return false;
      }
      NamedFile found = d_.find_named(uri, at + "/uri", true);
      if (found.outcome != Files::Outcome::found) {
        d_.report(Code("E6206"), &uri, at + "/uri", found.problem, found.outside ? kRootHint : "");
        return false;
      }
      buffer.owner = std::move(found.bytes);
      loaded_[uri.text] = buffer.owner;
      d_.file_bytes += buffer.owner->size();
    }
    buffer.bytes = as_bytes(*buffer.owner);
    return true;
  }

  void find_view(std::size_t index, const Json& json) {
    View& view = d_.views[index];
    const std::string at = pointer("bufferViews", index);
    if (json.broken) return;
    view.stride = static_cast<std::uint32_t>(size_of(json, "byteStride", 0));
    const Json* packed = extension_of(json, "EXT_meshopt_compression", "KHR_meshopt_compression");
    if (packed) {
      view.compressed = true;
      queue(index, *packed, size_of(json, "byteLength", 0), at);
      return;
    }
    const Buffer& buffer = d_.buffers[size_of(json, "buffer", 0)];
    const std::uint64_t offset = size_of(json, "byteOffset", 0);
    const std::uint64_t length = size_of(json, "byteLength", 0);
    view.offset = offset;
    if (offset > buffer.declared || length > buffer.declared - offset) {
      d_.report(Code("E6206"), &json, at,
                fmt::format("{} bytes from {} on do not fit into the buffer's {}", length, offset,
                            buffer.declared));
      return;
    }
    view.length = length;
    if (offset > buffer.bytes.size() || length > buffer.bytes.size() - offset) return;
    view.bytes = buffer.bytes.subspan(offset, length);
    view.sound = true;
  }

  void refuse(const std::string& at, std::string message) {
    d_.report(Code("E6210"), nullptr, at, "meshopt: " + std::move(message));
  }

  // What a stream must hold at least: for each block of 256 vertices a header byte for each byte of
  // a vertex; for each triangle or index a byte.
  static bool can_hold(const Packed& packed) {
    const std::uint64_t bytes = packed.bytes.size(), count = packed.count;
    if (packed.mode == 'A') return (count + 255) / 256 <= bytes / packed.stride + 1;
    return (packed.mode == 'T' ? count / 3 : count) <= bytes;
  }

  void queue(std::size_t index, const Json& json, std::uint64_t view_bytes, const std::string& at) {
    const Buffer& buffer = d_.buffers[size_of(json, "buffer", 0)];
    const std::uint64_t offset = size_of(json, "byteOffset", 0);
    const std::uint64_t length = size_of(json, "byteLength", 0);
    if (offset > buffer.bytes.size() || length > buffer.bytes.size() - offset)
      return refuse(at, fmt::format("{} bytes from {} on do not fit into the buffer's {}", length,
                                    offset, buffer.bytes.size()));
    const Json* mode = json.find("mode");
    const Json* filter = json.find("filter");
    const std::uint64_t count = size_of(json, "count", 0);
    Packed packed{
        index,         buffer.bytes.subspan(offset, length), size_of(json, "byteStride", 4), count,
        mode->text[0], filter ? filter->text[0] : 'N'};
    const std::size_t stride = packed.stride;
    const bool vertices = packed.mode == 'A';
    if (vertices ? stride % 4 != 0 : stride != 2 && stride != 4)
      return refuse(at, fmt::format("elements of {} bytes", stride));
    if (packed.mode == 'T' && count % 3 != 0)
      return refuse(at, fmt::format("{} indices make no triangles", count));
    const char f = packed.filter;
    if (f == 'C' || (f != 'N' && !vertices) || (f == 'O' && stride != 4 && stride != 8) ||
        (f == 'Q' && stride != 8))
      return refuse(at, fmt::format("the filter {} over elements of {} bytes",
                                    in_quotes(filter->text), stride));
    if (!can_hold(packed))
      return refuse(at, fmt::format("{} bytes cannot hold {} elements", length, count));
    if (!d_.charge(count * stride, at)) return;
    d_.views[index].length = count * stride;
    if (count * stride != view_bytes)
      d_.report(Code("E6206"), &json, at,
                fmt::format("the view has {} bytes, its stream {}", view_bytes, count * stride));
    packed_.push_back(packed);
  }

  void decode_one(Packed& packed) {
    auto out = std::make_shared<std::vector<std::byte>>(packed.count * packed.stride);
    const auto* bytes = reinterpret_cast<const unsigned char*>(packed.bytes.data());
    const std::size_t size = packed.bytes.size();
    int failure = 0;
    if (packed.mode == 'A')
      failure = meshopt_decodeVertexBuffer(out->data(), packed.count, packed.stride, bytes, size);
    else if (packed.mode == 'T')
      failure = meshopt_decodeIndexBuffer(out->data(), packed.count, packed.stride, bytes, size);
    else
      failure = meshopt_decodeIndexSequence(out->data(), packed.count, packed.stride, bytes, size);
    if (failure != 0) return;
    if (packed.filter == 'O') meshopt_decodeFilterOct(out->data(), packed.count, packed.stride);
    if (packed.filter == 'Q') meshopt_decodeFilterQuat(out->data(), packed.count, packed.stride);
    if (packed.filter == 'E') meshopt_decodeFilterExp(out->data(), packed.count, packed.stride);
    packed.good = true;
    View& view = d_.views[packed.view];
    view.decoded = std::move(out);
    view.bytes = *view.decoded;
    view.sound = true;
  }

  void decode() {
    parallel_for(
        packed_.size(), [&](std::size_t i) { decode_one(packed_[i]); }, d_.file.job);
    for (const Packed& packed : packed_)
      if (!packed.good) refuse(pointer("bufferViews", packed.view), "the stream is damaged");
  }

  Document& d_;
  std::uint32_t files_ = 0;
  std::map<std::string, SharedText> loaded_;
  std::vector<Packed> packed_;
};

// ---- accessors

class AccessorCheck {
 public:
  explicit AccessorCheck(Document& document) : d_(document) {}

  void run() {
    const std::vector<Json>& list = d_.root.list("accessors");
    d_.accessors.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      d_.accessors[i].json = &list[i];
      if (list[i].broken) continue;
      at_ = pointer("accessors", i);
      check(d_.accessors[i], list[i]);
    }
  }

 private:
  bool bad(const Json& json, std::string message, Code code = Code("E6206")) {
    d_.report(code, &json, at_, std::move(message));
    return false;
  }

  // Bytes of an element; the columns of a matrix begin at multiples of 4.
  static void set_shape(Accessor& a, const std::string& type) {
    const std::size_t size = component_bytes(a.component);
    if (type.starts_with("MAT")) {
      const std::size_t n = static_cast<std::size_t>(type[3] - '0');
      a.width = static_cast<int>(n * n);
      a.matrix = true;
      a.element = ((n * size + 3) & ~std::size_t{3}) * n;
    } else {
      a.width = type == "SCALAR" ? 1 : type[3] - '0';
      a.element = static_cast<std::size_t>(a.width) * size;
    }
  }

  void check(Accessor& a, const Json& json) {
    a.component = static_cast<int>(json.find("componentType")->number);
    set_shape(a, json.find("type")->text);
    a.count = size_of(json, "count", 0);
    a.offset = size_of(json, "byteOffset", 0);
    a.stride = a.element;
    bool sound = true;
    if (const Json* normalised = json.find("normalized")) {
      a.normalised = normalised->number != 0;
      if (a.normalised && (a.component == 5126 || a.component == 5125))
        bad(*normalised,
            fmt::format(
                "'normalized' is true of componentType {}, expected bytes or shorts: 5120 to "
                "5123",
                a.component),
            Code("E6204"));
    }
    for (const char* key : {"min", "max"})
      if (const Json* bound = json.find(key)) check_bound(a, *bound, key);
    if (a.matrix && a.offset % 4 != 0)
      sound = bad(json, fmt::format("a matrix at offset {}, not a multiple of 4", a.offset));
    if (const Json* view = json.find("bufferView")) {
      a.view = static_cast<std::ptrdiff_t>(view->number);
      const View& v = d_.views[static_cast<std::size_t>(a.view)];
      if (v.stride > 0) a.stride = v.stride;
      if (v.stride > 0 && v.stride < a.element)
        sound = bad(json, fmt::format("elements of {} bytes every {}", a.element, v.stride));
      sound = fits(json, v, a.offset, a.count, a.stride, a.element, component_bytes(a.component)) &&
              sound;
    }
    if (const Json* sparse = json.find("sparse")) sound = check_sparse(a, *sparse) && sound;
    a.sound = sound;
  }

  // Bounds of integers are integers, and of their type.
  void check_bound(const Accessor& a, const Json& bound, const char* key) {
    if (bound.items.size() != static_cast<std::size_t>(a.width))
      bad(bound, fmt::format("'{}' has {} numbers, not {}", key, bound.items.size(), a.width),
          Code("E6204"));
    if (a.is_float()) return;
    const bool with_sign = a.component == 5120 || a.component == 5122;
    const double values = std::ldexp(1.0, 8 * static_cast<int>(component_bytes(a.component)));
    const double least = with_sign ? -values / 2 : 0, most = least + values - 1;
    for (const Json& x : bound.items)
      if (!x.integral || x.number < least || x.number > most)
        bad(x,
            fmt::format("'{}' is {}, which type {} cannot hold", key, format_double(x.number),
                        a.component),
            Code("E6204"));
  }

  // Whether count elements lie in the view, there or not. A view without a length was reported.
  bool fits(const Json& json, const View& view, std::uint64_t offset, std::uint64_t count,
            std::uint64_t stride, std::uint64_t element, std::size_t component) {
    if (offset % component != 0)
      return bad(json, fmt::format("the offset {} is not a multiple of {}", offset, component));
    if ((view.offset + offset) % component != 0)
      return bad(json, fmt::format("the offset {} in the buffer is not a multiple of {}",
                                   view.offset + offset, component));
    const std::uint64_t size = view.length;
    if (size == 0) return false;
    if (offset <= size && element <= size - offset &&
        count - 1 <= (size - offset - element) / stride)
      return view.sound;
    return bad(json, fmt::format("{} elements of {} bytes from {} on do not fit into the view's {}",
                                 count, element, offset, size));
  }

  bool check_sparse(Accessor& a, const Json& json) {
    const Json* indices = json.find("indices");
    const Json* values = json.find("values");
    Sparse& s = a.sparse;
    s.count = size_of(json, "count", 0);
    s.index_component = static_cast<int>(indices->find("componentType")->number);
    s.index_view = size_of(*indices, "bufferView", 0);
    s.index_offset = size_of(*indices, "byteOffset", 0);
    s.value_view = size_of(*values, "bufferView", 0);
    s.value_offset = size_of(*values, "byteOffset", 0);
    bool sound = true;
    if (s.count > a.count)
      sound = bad(json, fmt::format("{} sparse values for {} elements", s.count, a.count));
    for (const std::size_t view : {s.index_view, s.value_view})
      if (d_.views[view].stride > 0) sound = bad(json, "the view of sparse data has a byteStride");
    const std::size_t size = component_bytes(s.index_component);
    sound =
        fits(*indices, d_.views[s.index_view], s.index_offset, s.count, size, size, size) && sound;
    sound = fits(*values, d_.views[s.value_view], s.value_offset, s.count, a.element, a.element,
                 component_bytes(a.component)) &&
            sound;
    a.is_sparse = sound;
    if (sound) check_places(a, json);
    return sound;
  }

  // The elements that sparse values are for.
  void check_places(const Accessor& a, const Json& json) {
    const std::vector<std::uint32_t> places = sparse_places(d_, a);
    const auto increases = [](std::uint32_t p, std::uint32_t q) { return p < q; };
    if (std::adjacent_find(places.begin(), places.end(), std::not_fn(increases)) != places.end())
      bad(json, "the indices of sparse values do not increase", Code("E6207"));
    if (std::any_of(places.begin(), places.end(), [&](std::uint32_t p) { return p >= a.count; }))
      bad(json, "a sparse value is for an element that does not exist", Code("E6207"));
  }

  Document& d_;
  std::string at_;
};

}  // namespace

void load_buffers(Document& document) { BufferLoader(document).run(); }
void check_accessors(Document& document) { AccessorCheck(document).run(); }

}  // namespace panwright::importers::gltf
