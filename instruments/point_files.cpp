#include "instruments/point_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <span>
#include <type_traits>
#include <vector>

#include "base/axis_box.h"
#include "base/file.h"
#include "base/text.h"
#include "image/arrays.h"
#include "image/whole.h"

namespace panwright::instruments {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kPcdPoint = 58, kPlyPoint = 79;  // bytes
constexpr std::size_t kMostHeader = 4096;

// Numbers one after the other, little-endian.
class ByteList {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  void add_text(std::string_view text) {
    const auto bytes = as_bytes(text);
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  // Text in a field of fixed size, with zeros.
  void add_field(std::string_view text, std::size_t size) {
    text = text.substr(0, size);
    add_text(text);
    bytes_.resize(bytes_.size() + size - text.size());
  }
  void add_zeros(std::size_t count) { bytes_.resize(bytes_.size() + count); }
  void reserve(std::size_t count) { bytes_.reserve(count); }
  std::size_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

// ---- .npz

template <class T>
constexpr const char* numpy_type() {
  if constexpr (std::is_same_v<T, double>) return "<f8";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "<u4";
  return "|u1";
}

template <class T, class List, class Get>
image::Array array_of(const char* name, const List& list, const Get& get) {
  ByteList bytes;
  bytes.reserve(list.size() * sizeof(T));
  for (const auto& each : list) bytes.add(static_cast<T>(get(each)));
  return {name, numpy_type<T>(), {list.size()}, bytes.take()};
}

template <class List, class Get>
image::Array vectors_of(const char* name, const List& list, const Get& get) {
  ByteList bytes;
  for (const auto& each : list) {
    const Vec3 v = get(each);
    for (int k = 0; k < 3; ++k) bytes.add(v[k]);
  }
  return {name, "<f8", {list.size(), 3}, bytes.take()};
}

bool write_npz(const LidarCloud& cloud, const std::filesystem::path& path, DiagnosticLog& log) {
  using P = LidarPoint;
  const auto& points = cloud.points;
  std::vector<image::Array> arrays;
  arrays.push_back(vectors_of("position", points, [](const P& p) { return p.position; }));
  arrays.push_back(array_of<double>("range", points, [](const P& p) { return p.range; }));
  arrays.push_back(array_of<double>("intensity", points, [](const P& p) { return p.intensity; }));
  arrays.push_back(
      array_of<double>("reflectance", points, [](const P& p) { return p.reflectance; }));
  arrays.push_back(array_of<double>("time", points, [](const P& p) { return p.time; }));
  arrays.push_back(array_of<std::uint32_t>("pulse", points, [](const P& p) { return p.pulse; }));
  arrays.push_back(array_of<std::uint8_t>("echo", points, [](const P& p) { return p.echo; }));
  arrays.push_back(array_of<std::uint8_t>("echoes", points, [](const P& p) { return p.echoes; }));
  arrays.push_back(array_of<std::uint8_t>("flags", points, [](const P& p) { return p.flags; }));
  arrays.push_back(array_of<double>("true_range", points, [](const P& p) { return p.true_range; }));
  arrays.push_back(array_of<double>("share", points, [](const P& p) { return p.share; }));
  arrays.push_back(array_of<double>("cosine", points, [](const P& p) { return p.cosine; }));
  arrays.push_back(
      array_of<std::uint32_t>("target_id", points, [](const P& p) { return p.ids.target; }));
  arrays.push_back(
      array_of<std::uint32_t>("node_id", points, [](const P& p) { return p.ids.node; }));
  arrays.push_back(
      array_of<std::uint32_t>("material_id", points, [](const P& p) { return p.ids.material; }));
  arrays.push_back(
      array_of<std::uint32_t>("instance_id", points, [](const P& p) { return p.ids.instance; }));
  arrays.push_back(
      vectors_of("pulse_direction", cloud.pulses, [](const Pulse& p) { return p.direction; }));
  arrays.push_back(
      array_of<double>("pulse_time", cloud.pulses, [](const Pulse& p) { return p.time; }));
  arrays.push_back(
      array_of<std::uint32_t>("pulse_row", cloud.pulses, [](const Pulse& p) { return p.row; }));
  arrays.push_back(array_of<std::uint32_t>("pulse_column", cloud.pulses,
                                           [](const Pulse& p) { return p.column; }));
  arrays.push_back(
      array_of<std::uint8_t>("pulse_status", cloud.status, [](PulseStatus s) { return s; }));
  ByteList poses;
  for (const world::Pose& pose : cloud.poses)
    for (const double each : {pose.translation.x, pose.translation.y, pose.translation.z,
                              pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
      poses.add(each);
  arrays.push_back({"world_from_instrument", "<f8", {cloud.poses.size(), 7}, poses.take()});
  return image::write_arrays(path, arrays, log);
}

// ---- .pcd

// A cloud of a grid with one echo at most a pulse is organised: a point a pulse, NaN without.
bool is_organised(const LidarCloud& cloud) {
  return cloud.columns > 0 &&
         std::ranges::none_of(cloud.points, [](const LidarPoint& p) { return p.echoes > 1; });
}

bool write_pcd(const LidarCloud& cloud, const std::filesystem::path& path, DiagnosticLog& log) {
  const bool grid = is_organised(cloud);
  const std::size_t count = grid ? cloud.pulses.size() : cloud.points.size();
  ByteList out;
  out.add_text(fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
      "FIELDS x y z intensity range t true_range cosine flags echo target_id node_id material_id\n"
      "SIZE 4 4 4 4 8 8 8 4 1 1 4 4 4\nTYPE F F F F F F F F U U U U U\n"
      "COUNT 1 1 1 1 1 1 1 1 1 1 1 1 1\nWIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\n"
      "DATA binary\n",
      grid ? cloud.columns : count, grid ? cloud.rows : 1, count));
  const auto add = [&](const LidarPoint& p, double time) {
    for (const double each : {p.position.x, p.position.y, p.position.z, p.intensity})
      out.add(static_cast<float>(each));
    for (const double each : {p.range, time, p.true_range}) out.add(each);
    out.add(static_cast<float>(p.cosine));
    out.add(p.flags);
    out.add(p.echo);
    for (const std::uint32_t each : {p.ids.target, p.ids.node, p.ids.material}) out.add(each);
  };
  if (!grid) {
    for (const LidarPoint& p : cloud.points) add(p, p.time);
    return write_file(path, out.bytes(), log);
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  LidarPoint none;
  none.position = Vec3(kNone);
  none.range = none.intensity = kNone;
  // rows and columns as they stand in space, whatever the order of the pulses
  std::vector<const LidarPoint*> at(count);
  for (const LidarPoint& p : cloud.points) {
    const Pulse& pulse = cloud.pulses[p.pulse];
    at[std::size_t{pulse.row} * cloud.columns + pulse.column] = &p;
  }
  std::vector<double> times(count);
  for (const Pulse& pulse : cloud.pulses)
    times[std::size_t{pulse.row} * cloud.columns + pulse.column] = pulse.time;
  for (std::size_t i = 0; i < count; ++i) add(at[i] ? *at[i] : none, times[i]);
  return write_file(path, out.bytes(), log);
}

// ---- .ply

bool write_ply(const LidarCloud& cloud, const std::filesystem::path& path, DiagnosticLog& log) {
  ByteList out;
  out.add_text(fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\n"
      "property double y\nproperty double z\nproperty float intensity\nproperty float "
      "reflectance\nproperty double range\nproperty double time\nproperty double true_range\n"
      "property float cosine\nproperty uchar flags\nproperty uchar echo\nproperty uchar echoes\n"
      "property uint pulse\nproperty uint target_id\nproperty uint node_id\nproperty uint "
      "material_id\nend_header\n",
      cloud.points.size()));
  for (const LidarPoint& p : cloud.points) {
    for (int k = 0; k < 3; ++k) out.add(p.position[k]);
    out.add(static_cast<float>(p.intensity));
    out.add(static_cast<float>(p.reflectance));
    for (const double each : {p.range, p.time, p.true_range}) out.add(each);
    out.add(static_cast<float>(p.cosine));
    for (const std::uint8_t each : {p.flags, p.echo, p.echoes}) out.add(each);
    for (const std::uint32_t each : {p.pulse, p.ids.target, p.ids.node, p.ids.material})
      out.add(each);
  }
  return write_file(path, out.bytes(), log);
}

// ---- .csv

bool write_csv(const LidarCloud& cloud, const std::filesystem::path& path, DiagnosticLog& log) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out),
                 "x,y,z,range,intensity,reflectance,time,pulse,row,column,echo,echoes,flags,"
                 "true_range,share,cosine,target_id,node_id,material_id,instance_id\n");
  for (const LidarPoint& p : cloud.points) {
    const Pulse& pulse = cloud.pulses[p.pulse];
    fmt::format_to(std::back_inserter(out), "{},{},{},{},{},{},{},{},{},{},{},{},{},", p.position.x,
                   p.position.y, p.position.z, p.range, p.intensity, p.reflectance, p.time, p.pulse,
                   pulse.row, pulse.column, p.echo, p.echoes, p.flags);
    // of a false alarm empty
    if (!std::isnan(p.true_range)) fmt::format_to(std::back_inserter(out), "{}", p.true_range);
    fmt::format_to(std::back_inserter(out), ",{},{},{},{},{},{}\n", p.share, p.cosine, p.ids.target,
                   p.ids.node, p.ids.material, p.ids.instance);
  }
  return write_file(path, std::as_bytes(std::span(out.data(), out.size())), log);
}

// ---- .las: ASPRS, "LAS specification 1.4 - R15", 2019, point format 6 with extra bytes

constexpr std::uint16_t kLasHeader = 375, kLasPoint = 30, kExtra = 192, kVlr = 54;

struct ExtraField {
  const char* name;
  std::uint8_t type;  // 5 u32, 9 f32, 10 f64
  const char* what;
};
constexpr ExtraField kExtraFields[] = {
    {"range", 10, "measured, metres"},      {"true_range", 10, "metres; NaN: false alarm"},
    {"electrons", 9, "measured intensity"}, {"cosine", 9, "of incidence"},
    {"target_id", 5, "index + 1"},          {"node_id", 5, "index + 1"},
    {"material_id", 5, "index + 1"},        {"flags", 5, "docs/lidar.md"}};
constexpr std::uint16_t kExtraBytes = 2 * 8 + 6 * 4;

void add_las_header(const LidarCloud& cloud, const std::string& software, double scale,
                    const Vec3& offset, const AxisBox& box, ByteList& out) {
  const auto vlr = static_cast<std::uint32_t>(kVlr + kExtra * std::size(kExtraFields));
  out.add_text("LASF");
  out.add(std::uint16_t{0});   // source
  out.add(std::uint16_t{16});  // WKT, as format 6 must say; there is no reference system
  out.add_zeros(16);           // GUID
  out.add(std::uint8_t{1});
  out.add(std::uint8_t{4});
  out.add_field("simulated", 32);
  out.add_field(software, 32);
  out.add_zeros(4);  // date: none, so that bytes repeat
  out.add(kLasHeader);
  out.add(static_cast<std::uint32_t>(kLasHeader + vlr));
  out.add(std::uint32_t{1});  // variable length records
  out.add(std::uint8_t{6});
  out.add(static_cast<std::uint16_t>(kLasPoint + kExtraBytes));
  out.add_zeros(4 + 20);  // counts of older readers
  for (int k = 0; k < 3; ++k) out.add(scale);
  for (int k = 0; k < 3; ++k) out.add(offset[k]);
  for (int k = 0; k < 3; ++k) {
    out.add(box.high[k]);
    out.add(box.low[k]);
  }
  out.add_zeros(8 + 8 + 4);  // waveforms, extended records
  out.add(static_cast<std::uint64_t>(cloud.points.size()));
  std::uint64_t returns[15] = {};
  for (const LidarPoint& p : cloud.points) ++returns[std::min<std::size_t>(p.echo, 14)];
  for (const std::uint64_t each : returns) out.add(each);
  out.add_zeros(2);
  out.add_field("LASF_Spec", 16);
  out.add(std::uint16_t{4});
  out.add(static_cast<std::uint16_t>(vlr - kVlr));
  out.add_field("extra bytes", 32);
  for (const ExtraField& field : kExtraFields) {
    out.add_zeros(2);
    out.add(field.type);
    out.add(std::uint8_t{0});
    out.add_field(field.name, 32);
    out.add_zeros(4 + 5 * 24);
    out.add_field(field.what, 32);
  }
}

bool write_las(const LidarCloud& cloud, const std::filesystem::path& path,
               const std::string& software, DiagnosticLog& log) {
  AxisBox box;
  for (const LidarPoint& p : cloud.points) box.add(p.position);
  if (box.empty()) box = {Vec3(0), Vec3(0)};
  // a power of ten, from a micrometre, by which 31 bits reach over all
  const Vec3 offset = glm::floor(box.centre());
  double scale = 1e-6;
  while (box.longest() + 2 > scale * 2e9) scale *= 10;
  const auto whole = [&](double value, double from) {
    return static_cast<std::int32_t>(std::floor((value - from) / scale + 0.5));
  };
  // as readers find them
  for (int k = 0; k < 3; ++k) {
    box.low[k] = whole(box.low[k], offset[k]) * scale + offset[k];
    box.high[k] = whole(box.high[k], offset[k]) * scale + offset[k];
  }
  ByteList out;
  out.reserve(2048 + cloud.points.size() * (kLasPoint + kExtraBytes));
  add_las_header(cloud, software, scale, offset, box, out);
  for (const LidarPoint& p : cloud.points) {
    for (int k = 0; k < 3; ++k) out.add(whole(p.position[k], offset[k]));
    constexpr double kWhite = 10000;  // of a reflectance of 1
    out.add(static_cast<std::uint16_t>(
        std::floor(std::clamp(kWhite * p.reflectance, 0.0, 65535.0) + 0.5)));
    const unsigned number = std::min(p.echo + 1u, 15u), of = std::min<unsigned>(p.echoes, 15u);
    out.add(static_cast<std::uint8_t>(number | (of << 4)));
    out.add(std::uint8_t{0});
    out.add(static_cast<std::uint8_t>((p.flags & kFalseAlarm) != 0 ? 7 : 1));  // 7: noise
    out.add(std::uint8_t{0});
    out.add(std::int16_t{0});
    out.add(std::uint16_t{0});
    out.add(p.time);
    out.add(p.range);
    out.add(p.true_range);
    out.add(static_cast<float>(p.intensity));
    out.add(static_cast<float>(p.cosine));
    for (const std::uint32_t each :
         {p.ids.target, p.ids.node, p.ids.material, std::uint32_t{p.flags}})
      out.add(each);
  }
  return write_file(path, out.bytes(), log);
}

// ---- completeness

// Returns the number behind a word of a header; none: no such word.
std::optional<double> number_after(std::string_view header, std::string_view word) {
  const std::size_t at = header.find(word);
  if (at == header.npos) return std::nullopt;
  header.remove_prefix(at + word.size());
  return parse_double(header.substr(0, header.find('\n')));
}

// Of a header as text up to a last line, and then points of one size.
bool is_whole_listing(std::string_view text, std::string_view last_line, std::string_view word,
                      std::size_t size) {
  const std::size_t end = text.substr(0, kMostHeader).find(last_line);
  if (end == text.npos) return false;
  const auto count = number_after(text.substr(0, end), word);
  text.remove_prefix(end + last_line.size());
  return count && static_cast<double>(text.size()) == *count * static_cast<double>(size);
}

bool is_whole_las(std::string_view text) {
  const auto field = [&](std::size_t at, auto value) {
    std::memcpy(&value, text.data() + at, sizeof value);
    return value;
  };
  if (text.size() < kLasHeader || !text.starts_with("LASF")) return false;
  const auto begin = field(96, std::uint32_t{});
  const auto length = field(105, std::uint16_t{});
  if (begin > text.size() || length == 0) return false;
  const std::size_t points = text.size() - begin;
  return points % length == 0 && points / length == field(247, std::uint64_t{});
}

}  // namespace

bool is_point_file(const std::filesystem::path& path) {
  constexpr std::string_view kTypes[] = {".npz", ".pcd", ".ply", ".csv", ".las"};
  return std::ranges::find(kTypes, path.extension().string()) != std::end(kTypes);
}

bool is_whole_point_file(const std::filesystem::path& path) {
  const std::string type = path.extension().string();
  if (type == ".npz") return image::is_whole(path);
  DiagnosticLog none;
  const auto file = MappedFile::open(path, none);
  if (!file) return false;
  const std::string_view text(reinterpret_cast<const char*>(file->bytes().data()),
                              file->bytes().size());
  if (type == ".pcd") return is_whole_listing(text, "\nDATA binary\n", "\nPOINTS ", kPcdPoint);
  if (type == ".ply")
    return is_whole_listing(text, "\nend_header\n", "\nelement vertex ", kPlyPoint);
  return type == ".las" ? is_whole_las(text) : text.ends_with('\n');
}

bool write_points(const LidarCloud& cloud, const std::filesystem::path& path,
                  const std::string& software, DiagnosticLog& log) {
  const std::string type = path.extension().string();
  if (type == ".npz") return write_npz(cloud, path, log);
  if (type == ".pcd") return write_pcd(cloud, path, log);
  if (type == ".ply") return write_ply(cloud, path, log);
  if (type == ".las") return write_las(cloud, path, software, log);
  return write_csv(cloud, path, log);
}

}  // namespace panwright::instruments
