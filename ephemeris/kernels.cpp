#include "ephemeris/kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/text.h"
#include "ephemeris/internal/clocks.h"
#include "ephemeris/internal/data.h"
#include "ephemeris/internal/names.h"

namespace panwright::ephemeris {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxTextKernel = 256u << 20;
constexpr std::size_t kMostFiles = 1000;  // of a meta-kernel

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_das(std::string_view text) {
  return text.starts_with("DAS/") || text.starts_with("NAIF/DAS") || text.starts_with("DASETF");
}

// Adds one kernel. False: E8015.
bool add_kernel(Kernels::Data& data, const std::string& name, std::span<const std::byte> bytes,
                DiagnosticLog& log) {
  const auto refuse = [&](const std::string& why, const char* hint = "") {
    log.report_file(Code("E8015"), name, why, hint);
    return false;
  };
  const std::string_view text = as_text(bytes);
  std::string problem;
  if (is_daf(bytes)) {
    Daf daf;
    if (!read_daf(bytes, daf, problem)) return refuse(problem);
    data.dafs.push_back(std::move(daf));
    const std::size_t first = data.infos.size();
    if (!data.add(data.dafs.back(), name, problem)) return refuse(problem);
    std::set<std::string> skipped;
    std::size_t count = 0;
    for (std::size_t i = first; i < data.infos.size(); ++i)
      if (!data.infos[i].read) {
        skipped.insert(data.infos[i].kind);
        ++count;
      }
    if (count > 0)
      log.report_file(Code("W8016"), name,
                      fmt::format("{} of {}: {}", counted(count, "segment"),
                                  data.infos.size() - first, fmt::join(skipped, ", ")));
    return true;
  }
  if (is_das(text))
    return refuse("a DAS file, as of shapes (DSK) and event logs, is not read",
                  "shapes are read as OBJ, PLY or glTF");
  if (!is_text_kernel(text.substr(0, kMaxTextKernel)))
    return refuse("neither a DAF file nor a text kernel (KPL/…, \\begindata)");
  if (text.size() > kMaxTextKernel) return refuse("a text kernel over 256 MB");
  if (!data.pool.read(text, problem)) return refuse(problem);
  return true;
}

// Texts alone: comments of binary files may have the word.
bool is_meta_kernel(std::string_view text) {
  return text.size() <= kMaxTextKernel && text.substr(0, 1024).find('\0') == text.npos &&
         !is_daf(std::as_bytes(std::span(text))) && is_text_kernel(text) &&
         text.find("KERNELS_TO_LOAD") != text.npos;
}

// Files that a meta-kernel names, with its symbols replaced; none of a damaged one.
std::vector<fs::path> files_of(std::string_view text, const fs::path& path) {
  Pool pool;
  std::vector<fs::path> out;
  std::string problem;
  if (!pool.read(text, problem)) return out;
  const auto* const names = pool.texts("KERNELS_TO_LOAD");
  if (names == nullptr) return out;
  const auto* const symbols = pool.texts("PATH_SYMBOLS");
  const auto* const values = pool.texts("PATH_VALUES");
  std::string joined_name;  // a text that goes on ends with +
  for (const std::string& part : *names) {
    joined_name += part;
    if (joined_name.ends_with('+')) {
      joined_name.pop_back();
      continue;
    }
    for (std::size_t i = 0; symbols && values && i < std::min(symbols->size(), values->size()); ++i)
      if (const std::string symbol = "$" + (*symbols)[i]; joined_name.starts_with(symbol))
        joined_name = (*values)[i] + joined_name.substr(symbol.size());
    out.push_back(path.parent_path() / joined_name);
    joined_name.clear();
  }
  return out;
}

// Positions of the centre of a frame decide when its axes are taken.
double frame_time(const Kernels::Data& data, int frame, int target, int observer, double et,
                  double light_time) {
  const auto centre = data.centre_of(frame);
  if (!centre || *centre == observer) return et;
  if (*centre == target) return et - light_time;
  std::string ignored;
  const auto seen = data.relative(*centre, observer, et, ignored);
  return seen ? et - length(seen->position) / kLightSpeed : et;
}

std::string calendar_text(double seconds) {
  constexpr double kDay = 86400;
  const double shifted = seconds + kDay / 2;
  double day = std::floor(shifted / kDay);
  double nanoseconds = std::round((shifted - day * kDay) * 1e9);
  if (nanoseconds >= kDay * 1e9) {
    nanoseconds = 0;
    ++day;
  }
  // Hinnant's algorithm
  const auto days = static_cast<std::int64_t>(day) + 730425;
  const std::int64_t era = (days >= 0 ? days : days - 146096) / 146097;
  const std::int64_t of_era = days - era * 146097;
  const std::int64_t year = (of_era - of_era / 1460 + of_era / 36524 - of_era / 146096) / 365;
  const std::int64_t of_year = of_era - (365 * year + year / 4 - year / 100);
  const std::int64_t month = (5 * of_year + 2) / 153;
  const auto all = static_cast<std::int64_t>(nanoseconds);
  const std::int64_t second = all / 1'000'000'000;
  std::string out =
      fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", year + era * 400 + (month >= 10 ? 1 : 0),
                  month + (month < 10 ? 3 : -9), of_year - (153 * month + 2) / 5 + 1, second / 3600,
                  second / 60 % 60, second % 60);
  if (const std::int64_t rest = all % 1'000'000'000; rest > 0) {
    out += fmt::format(".{:09}", rest);
    out.erase(out.find_last_not_of('0') + 1);
  }
  return out;
}

// The light time and the state of a target as its light left. False: problem.
bool retarded(const Kernels::Data& data, int target, const State& observer, double et,
              bool converged, Apparent& out, std::string& problem) {
  constexpr int kMostSteps = 10;
  State of_target;
  double light_time = 0;
  const int steps = converged ? kMostSteps : 2;
  for (int i = 0; i < steps; ++i) {
    const auto then = data.relative(target, 0, et - light_time, problem);
    if (!then) return false;
    of_target = *then;
    const double before = light_time;
    const Vec3 ray = of_target.position - observer.position;
    light_time = length(ray) / kLightSpeed;
    out.state.position = ray;
    if (converged && std::abs(light_time - before) <= 1e-15 * std::abs(et)) break;
  }
  out.light_time = light_time;
  // the light time changes too
  const double distance = length(out.state.position);
  if (!(distance > 0)) {
    out.state.velocity = of_target.velocity - observer.velocity;
    return true;
  }
  const Vec3 along = out.state.position / (distance * kLightSpeed);
  const double rate =
      dot(along, of_target.velocity - observer.velocity) / (1 + dot(along, of_target.velocity));
  out.state.velocity = (1 - rate) * of_target.velocity - observer.velocity;
  return true;
}

// A direction, turned towards the observer's motion.
Vec3 with_stellar_aberration(const Vec3& position, const Vec3& velocity) {
  const double distance = length(position);
  const Vec3 axis = cross(position / distance, velocity / kLightSpeed);
  const double sine = length(axis);
  if (!(distance > 0) || !(sine > 0) || !(sine < 1)) return position;
  const Vec3 unit = axis / sine;
  const double cosine = std::sqrt(1 - sine * sine);
  return position * cosine + cross(unit, position) * sine;
}

}  // namespace

std::optional<Aberration> aberration_named(std::string_view name) {
  constexpr std::pair<std::string_view, Aberration> kNames[] = {
      {"NONE", Aberration::none}, {"LT", Aberration::lt},     {"LT+S", Aberration::lt_s},
      {"CN", Aberration::cn},     {"CN+S", Aberration::cn_s},
  };
  const std::string plain = plain_name(name);
  for (const auto& [text, value] : kNames)
    if (text == plain) return value;
  return std::nullopt;
}

bool is_kernel(std::span<const std::byte> bytes) {
  const std::string_view text = as_text(bytes);
  return is_daf(bytes) || is_das(text) || text.starts_with("KPL/");
}

Result<Kernels> Kernels::load(std::span<const std::filesystem::path> paths, DiagnosticLog& log) {
  auto data = std::make_shared<Data>();
  std::vector<std::pair<fs::path, bool>> queue;  // and whether a meta-kernel names it
  for (const fs::path& path : paths) queue.emplace_back(path, false);
  bool sound = true;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const auto [path, named] = queue[i];
    auto file = MappedFile::open(path, log);
    if (!file) {
      sound = false;
      continue;
    }
    if (file->bytes().size() > kMaxKernelBytes) {
      log.report_file(Code("E0104"), path.string(), "a kernel over 16 GiB");
      return failed;
    }
    data->files.push_back(std::move(*file));
    const auto bytes = data->files.back().bytes();
    const std::string_view text = as_text(bytes);
    if (!named && is_meta_kernel(text)) {
      const auto more = files_of(text, path);
      if (more.size() > kMostFiles) {
        log.report_file(Code("E8015"), path.string(),
                        fmt::format("it names {} files, at most {}", more.size(), kMostFiles));
        return failed;
      }
      std::size_t at = i + 1;
      for (const fs::path& each : more)
        queue.insert(queue.begin() + static_cast<std::ptrdiff_t>(at++), {each, true});
    }
    sound = add_kernel(*data, path.string(), bytes, log) && sound;
  }
  if (!sound) return failed;
  data->finish();
  return Kernels(std::move(data));
}

Result<Kernels> Kernels::of(std::span<const KernelBytes> kernels, DiagnosticLog& log) {
  auto data = std::make_shared<Data>();
  bool sound = true;
  for (const KernelBytes& each : kernels)
    sound = add_kernel(*data, each.name, each.bytes, log) && sound;
  if (!sound) return failed;
  data->finish();
  return Kernels(std::move(data));
}

std::optional<int> Kernels::body(std::string_view name) const {
  const std::string plain = plain_name(name);
  if (const auto found = data_->body_numbers.find(plain); found != data_->body_numbers.end())
    return found->second;
  if (const auto known = known_body(plain)) return known;
  const auto number = parse_double(plain);
  if (!number || !(std::abs(*number) < 2e9) || *number != std::floor(*number)) return std::nullopt;
  return static_cast<int>(*number);
}

std::optional<int> Kernels::frame(std::string_view name) const {
  if (const auto found = data_->frame_number(name)) return found;
  const auto number = parse_double(name);
  if (!number || !(std::abs(*number) < 2e9) || *number != std::floor(*number)) return std::nullopt;
  return static_cast<int>(*number);
}

std::string Kernels::body_name(int id) const {
  if (const auto found = data_->body_names.find(id); found != data_->body_names.end())
    return found->second;
  const auto known = known_body_name(id);
  return known.empty() ? std::to_string(id) : std::string(known);
}

std::string Kernels::frame_name(int id) const { return data_->frame_text(id); }

std::vector<std::string> Kernels::variables() const {
  std::vector<std::string> out;
  for (const auto& [name, values] : data_->pool.all()) out.push_back(name);
  return out;
}

std::optional<Apparent> Kernels::state(int target, int observer, int frame, double et,
                                       Aberration aberration, std::string& problem) const {
  problem.clear();
  Apparent out;
  double axes_time = et;
  if (aberration == Aberration::none) {
    const auto state = data_->relative(target, observer, et, problem);
    if (!state) return std::nullopt;
    out = {*state, length(state->position) / kLightSpeed};
  } else {
    const auto of_observer = data_->relative(observer, 0, et, problem);
    const bool converged = aberration == Aberration::cn || aberration == Aberration::cn_s;
    if (!of_observer || !retarded(*data_, target, *of_observer, et, converged, out, problem))
      return std::nullopt;
    if (aberration == Aberration::lt_s || aberration == Aberration::cn_s)
      out.state.position = with_stellar_aberration(out.state.position, of_observer->velocity);
    axes_time = frame_time(*data_, frame, target, observer, et, out.light_time);
  }
  if (frame == kJ2000) return out;
  const auto axes = data_->attitude(frame, axes_time, 0, problem);
  if (!axes) return std::nullopt;
  const Vec3 position = out.state.position;
  out.state.position = axes->from_j2000 * position;
  // without the frame's rate there is no velocity in it
  out.state.velocity = axes->rate
                           ? axes->from_j2000 * (out.state.velocity - cross(*axes->rate, position))
                           : Vec3(std::numeric_limits<double>::quiet_NaN());
  return out;
}

std::optional<Attitude> Kernels::attitude(int frame, double et, std::string& problem) const {
  problem.clear();
  return data_->attitude(frame, et, 0, problem);
}

std::optional<Vec3> Kernels::radii(int body) const {
  const auto* const radii = data_->pool.numbers(fmt::format("BODY{}_RADII", body));
  if (radii == nullptr || radii->size() != 3) return std::nullopt;
  return Vec3((*radii)[0], (*radii)[1], (*radii)[2]);
}

std::optional<double> Kernels::et_of_utc(std::string_view text, std::string& problem) const {
  problem.clear();
  return ephemeris::et_of_utc(data_->pool, text, problem);
}

std::optional<std::string> Kernels::utc_of_et(double et, std::string& problem) const {
  problem.clear();
  const auto utc = ephemeris::utc_of_et(data_->pool, et, problem);
  constexpr double kMost = 2.5e11;  // year 9900
  if (!utc) return std::nullopt;
  if (!(std::abs(*utc) < kMost)) {
    problem = "the date has no four-digit year";
    return std::nullopt;
  }
  return calendar_text(*utc);
}

std::optional<double> Kernels::et_of_ticks(int clock, double ticks, std::string& problem) const {
  problem.clear();
  return ephemeris::et_of_ticks(data_->pool, clock, ticks, problem);
}

std::optional<double> Kernels::ticks_of_et(int clock, double et, std::string& problem) const {
  problem.clear();
  return ephemeris::ticks_of_et(data_->pool, clock, et, problem);
}

std::vector<SegmentInfo> Kernels::segments() const {
  std::vector<SegmentInfo> out = data_->infos;
  for (SegmentInfo& each : out) {
    if (!each.in_ticks) continue;
    const auto begin = et_of_ticks_or(each.id, each.begin), end = et_of_ticks_or(each.id, each.end);
    if (!begin || !end) continue;
    each.begin = *begin;
    each.end = *end;
    each.in_ticks = false;
  }
  return out;
}

std::optional<double> Kernels::et_of_ticks_or(int instrument, double ticks) const {
  std::string ignored;
  return ephemeris::et_of_ticks(data_->pool, data_->clock_of(instrument), ticks, ignored);
}

std::optional<State> Kernels::segment_state(std::size_t index, double et) const {
  for (const auto* tracks : {&data_->bodies, &data_->angles})
    for (const auto& entry : *tracks)
      for (const OrbitSegment& segment : entry.second.segments) {
        State out;
        if (segment.info == index && spk_state(segment.layout, segment.data, et, out)) return out;
      }
  return std::nullopt;
}

std::optional<Attitude> Kernels::segment_pointing(std::size_t index, double ticks) const {
  for (const auto& entry : data_->turning)
    for (const AttitudeSegment& segment : entry.second) {
      if (segment.info != index || segment.layout.type == 0) continue;
      const auto read = ck_pointing(segment.layout, segment.data, ticks);
      if (read) return Attitude{read->from_reference, read->rate};
    }
  return std::nullopt;
}

}  // namespace panwright::ephemeris
