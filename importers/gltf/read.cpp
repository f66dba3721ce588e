#include "importers/gltf/read.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "base/math.h"
#include "base/parallel.h"

namespace panwright::importers::gltf {

namespace {

constexpr std::size_t kReadBlock = 1 << 15;  // elements of one piece of parallel work

template <class T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

// numbers of one element that are read: components of `from` into the first of `to`
template <class T>
void convert(const std::byte* from, std::size_t numbers, double scale, bool clamp, double* to) {
  for (std::size_t k = 0; k < numbers; ++k) {
    const double x = static_cast<double>(load<T>(from + k * sizeof(T))) * scale;
    to[k] = clamp ? std::max(x, -1.0) : x;
  }
}

struct Plan {
  int component;
  std::size_t numbers;  // of an element
  double scale;
  bool clamp;
};

void convert_element(const Plan& plan, const std::byte* from, double* to) {
  switch (plan.component) {
    case 5120:
      return convert<std::int8_t>(from, plan.numbers, plan.scale, plan.clamp, to);
    case 5121:
      return convert<std::uint8_t>(from, plan.numbers, plan.scale, false, to);
    case 5122:
      return convert<std::int16_t>(from, plan.numbers, plan.scale, plan.clamp, to);
    case 5123:
      return convert<std::uint16_t>(from, plan.numbers, plan.scale, false, to);
    case 5125:
      return convert<std::uint32_t>(from, plan.numbers, 1, false, to);
    default:
      return convert<float>(from, plan.numbers, 1, false, to);
  }
}

template <class Body>
void in_blocks(std::size_t count, const Body& body) {
  const std::size_t blocks = (count + kReadBlock - 1) / kReadBlock;
  parallel_for(blocks,
               [&](std::size_t b) { body(b * kReadBlock, std::min(count, (b + 1) * kReadBlock)); });
}

// Numbers that are not finite become 0. Returns how many elements had one.
std::size_t mend(double* numbers, std::size_t count, std::size_t width) {
  std::size_t bad = 0;
  for (std::size_t i = 0; i < count; ++i) {
    bool finite = true;
    for (std::size_t k = 0; k < width; ++k)
      finite = finite && numbers[i * width + k] - numbers[i * width + k] == 0;
    if (finite) continue;
    ++bad;
    for (std::size_t k = 0; k < width; ++k)
      if (!(numbers[i * width + k] - numbers[i * width + k] == 0)) numbers[i * width + k] = 0;
  }
  return bad;
}

std::uint32_t index_at(const std::byte* from, int component) {
  if (component == 5121) return load<std::uint8_t>(from);
  if (component == 5123) return load<std::uint16_t>(from);
  return load<std::uint32_t>(from);
}

}  // namespace

std::vector<std::uint32_t> sparse_places(const Document& document, const Accessor& a) {
  const std::byte* from = document.views[a.sparse.index_view].bytes.data() + a.sparse.index_offset;
  const std::size_t size = component_bytes(a.sparse.index_component);
  std::vector<std::uint32_t> places(a.sparse.count);
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = index_at(from + i * size, a.sparse.index_component);
  return places;
}

double scale_of(int component, bool normalised) {
  if (!normalised) return 1;
  switch (component) {
    case 5120:
      return 1.0 / 127;
    case 5121:
      return 1.0 / 255;
    case 5122:
      return 1.0 / 32767;
    case 5123:
      return 1.0 / 65535;
    default:
      return 1;
  }
}

bool may_invent(Document& document, std::uint64_t bytes, const std::string& object) {
  constexpr std::uint64_t kFree = 1 << 20;
  if (bytes > kFree && bytes / 64 > document.file_bytes) {
    document.report(Code("E6002"), nullptr, object,
                    fmt::format("{} bytes of zeros exceed the limit for a file of {} bytes", bytes,
                                document.file_bytes));
    return false;
  }
  return document.charge(bytes, object);
}

std::size_t count_not_finite(const Document& document, const Accessor& a) {
  if (!a.sound || !a.is_float()) return 0;
  const auto width = static_cast<std::size_t>(a.width);
  const auto bad_in = [&](const std::byte* from) {
    std::size_t bad = 0;
    for (std::size_t k = 0; k < width; ++k)
      if (!std::isfinite(load<float>(from + 4 * k))) ++bad;
    return bad;
  };
  std::vector<std::uint32_t> places;
  std::size_t found = 0;
  if (a.is_sparse) {
    places = sparse_places(document, a);
    const std::byte* from =
        document.views[a.sparse.value_view].bytes.data() + a.sparse.value_offset;
    for (std::size_t i = 0; i < places.size(); ++i) found += bad_in(from + i * a.element);
    std::sort(places.begin(), places.end());
  }
  if (a.view < 0) return found;
  const std::byte* from = document.views[static_cast<std::size_t>(a.view)].bytes.data() + a.offset;
  std::atomic<std::size_t> bad = found;
  in_blocks(a.count, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t one = bad_in(from + i * a.stride);
      if (one > 0 && !std::binary_search(places.begin(), places.end(), i)) here += one;
    }
    bad += here;
  });
  return bad;
}

template <class Vector>
std::vector<Vector> read_vectors(Document& document, std::size_t accessor,
                                 const std::string& object) {
  constexpr std::size_t kWidth = sizeof(Vector) / sizeof(double);
  const Accessor& a = document.accessors[accessor];
  if (!a.sound) return {};
  if (a.view < 0 && !may_invent(document, a.count * sizeof(Vector), object)) return {};
  std::vector<Vector> out(a.count, Vector(0));
  double* numbers = reinterpret_cast<double*>(out.data());
  const Plan plan{a.component, std::min<std::size_t>(kWidth, static_cast<std::size_t>(a.width)),
                  scale_of(a.component, a.normalised), a.normalised};
  std::atomic<std::size_t> bad = 0;
  if (a.view >= 0) {
    const std::byte* from =
        document.views[static_cast<std::size_t>(a.view)].bytes.data() + a.offset;
    in_blocks(a.count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        convert_element(plan, from + i * a.stride, numbers + i * kWidth);
      // note: sparse values may stand in their place
      if (a.is_float() && !a.is_sparse) bad += mend(numbers + begin * kWidth, end - begin, kWidth);
    });
  }
  if (a.is_sparse) {
    const std::byte* from =
        document.views[a.sparse.value_view].bytes.data() + a.sparse.value_offset;
    const std::vector<std::uint32_t> places = sparse_places(document, a);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i] >= a.count) continue;
      convert_element(plan, from + i * a.element, numbers + places[i] * kWidth);
    }
    bad += mend(numbers, a.count, kWidth);
  }
  if (bad > 0)
    document.report(
        Code("E6207"), a.json, object,
        fmt::format("{} of {} elements hold numbers that are not finite", bad.load(), a.count));
  return out;
}

template std::vector<Vec2> read_vectors(Document&, std::size_t, const std::string&);
template std::vector<Vec3> read_vectors(Document&, std::size_t, const std::string&);
template std::vector<Vec4> read_vectors(Document&, std::size_t, const std::string&);
template std::vector<Mat4> read_vectors(Document&, std::size_t, const std::string&);

template <class Vector>
std::vector<Vector> read_vectors_at(Document& document, std::size_t accessor,
                                    std::span<const std::uint32_t> places,
                                    const std::string& object) {
  constexpr std::size_t kWidth = sizeof(Vector) / sizeof(double);
  const Accessor& a = document.accessors[accessor];
  if (!a.sound) return {};
  std::vector<Vector> out(places.size(), Vector(0));
  if (a.is_sparse) {
    if (!document.charge(a.count * sizeof(Vector), object)) return {};
    const auto all = read_vectors<Vector>(document, accessor, object);
    if (all.empty()) return {};
    for (std::size_t i = 0; i < places.size(); ++i) out[i] = all[places[i]];
    return out;
  }
  if (a.view < 0) return out;
  double* numbers = reinterpret_cast<double*>(out.data());
  const Plan plan{a.component, std::min<std::size_t>(kWidth, static_cast<std::size_t>(a.width)),
                  scale_of(a.component, a.normalised), a.normalised};
  const std::byte* from = document.views[static_cast<std::size_t>(a.view)].bytes.data() + a.offset;
  for (std::size_t i = 0; i < places.size(); ++i)
    convert_element(plan, from + places[i] * a.stride, numbers + i * kWidth);
  if (a.is_float()) (void)mend(numbers, places.size(), kWidth);
  return out;
}

template std::vector<Vec2> read_vectors_at(Document&, std::size_t, std::span<const std::uint32_t>,
                                           const std::string&);
template std::vector<Vec3> read_vectors_at(Document&, std::size_t, std::span<const std::uint32_t>,
                                           const std::string&);
template std::vector<Vec4> read_vectors_at(Document&, std::size_t, std::span<const std::uint32_t>,
                                           const std::string&);

std::vector<std::uint32_t> read_indices(Document& document, std::size_t accessor,
                                        const std::string& object) {
  const Accessor& a = document.accessors[accessor];
  if (!a.sound) return {};
  if (a.view < 0 && !may_invent(document, a.count * 4, object)) return {};
  std::vector<std::uint32_t> out(a.count);
  if (a.view >= 0) {
    const std::byte* from =
        document.views[static_cast<std::size_t>(a.view)].bytes.data() + a.offset;
    in_blocks(a.count, [&](std::size_t begin, std::size_t end) {
      if (a.component == 5125 && a.stride == 4) {
        std::memcpy(&out[begin], from + begin * 4, (end - begin) * 4);
        return;
      }
      for (std::size_t i = begin; i < end; ++i) out[i] = index_at(from + i * a.stride, a.component);
    });
  }
  if (a.is_sparse) {
    const std::byte* from =
        document.views[a.sparse.value_view].bytes.data() + a.sparse.value_offset;
    const std::vector<std::uint32_t> places = sparse_places(document, a);
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] < a.count) out[places[i]] = index_at(from + i * a.element, a.component);
  }
  return out;
}

}  // namespace panwright::importers::gltf
