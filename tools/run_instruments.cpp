#include "tools/run_instruments.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"
#include "instruments/point_files.h"
#include "instruments/radar_files.h"
#include "tools/print.h"
#include "tools/radar_json.h"
#include "workspace/record.h"

namespace panwright::tools {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using instruments::LidarOptions;
using workspace::InstrumentKind;
using workspace::ScenarioInstrument;

constexpr std::uint64_t kMostInstrumentBytes = 1 << 20;

}  // namespace

struct RunInstruments::Moment {
  world::World world;
  world::Pose camera;  // world_from_camera
  std::uint64_t noise_seed = 0;

  template <class State>
  void set(const world::Pose& mount, State& state) const {
    state.world = world;
    state.pose = {camera.translation + camera.rotation * mount.translation,
                  camera.rotation * mount.rotation};
  }
};

// The world at times of a scenario.
class RunInstruments::Clock {
 public:
  Clock(const workspace::Scenario& scenario, workspace::ViewSession& session,
        const world::World& world, double begin, std::uint64_t number)
      : scenario_(scenario), session_(session), world_(world), begin_(begin), number_(number) {}

  double begin() const { return begin_; }

  // seconds: after the frame
  std::optional<Moment> at(double seconds, DiagnosticLog& log) {
    const auto frame = workspace::frame_at(scenario_, begin_ + seconds, log);
    if (!frame) return std::nullopt;
    const auto view = workspace::view_of(scenario_, *frame, number_, world_, log);
    if (!view) return std::nullopt;
    const auto made = session_.frame(*view, log);
    if (!made) return std::nullopt;
    Moment out{world_,
               {made->camera().position, made->camera().world_from_camera},
               *made->settings.noise_seed};
    workspace::show(*made, world_, out.world);
    return out;
  }

 private:
  const workspace::Scenario& scenario_;
  workspace::ViewSession& session_;
  const world::World& world_;
  const double begin_;
  const std::uint64_t number_;
};

bool RunInstruments::open(const world::World& world) {
  return std::ranges::all_of(scenario_.instruments,
                             [&](const ScenarioInstrument& each) { return open_one(each, world); });
}

bool RunInstruments::open_one(const ScenarioInstrument& what, const world::World& world) {
  One one;
  one.what = &what;
  const auto text = read_file(what.file, kMostInstrumentBytes, log_);
  if (!text) return false;
  one.text = *text;
  if (what.kind == InstrumentKind::radar) {
    auto radar = instruments::read_radar(*text, what.file, log_);
    if (!radar) return false;
    one.radar = *std::move(radar);
    one.span = one.radar.dwell;
  } else {
    auto lidar = instruments::read_lidar(*text, what.file, fs::path(what.file).parent_path(), log_);
    if (!lidar) return false;
    one.lidar = *std::move(lidar);
    const auto& table = one.lidar.scan.table;
    if (!table.empty()) one.pulses = hash128(std::as_bytes(std::span(table))).hex();
    const auto pulses = instruments::pulses_of(one.lidar.scan);
    if (!pulses.empty()) one.span = pulses.back().time;
    if (what.frame == "world") {
      one.frame_of = LidarOptions::kWorld;
    } else if (what.frame != "instrument") {
      const auto target = world.require(what.frame, log_);
      if (!target) return false;
      one.frame_of = static_cast<std::int32_t>(*target);
    }
  }
  all_.push_back(std::move(one));
  return true;
}

std::vector<std::string> RunInstruments::outputs_of(const std::string& stem) const {
  std::vector<std::string> out;
  for (const ScenarioInstrument& each : scenario_.instruments)
    for (const std::string& type : each.types) out.push_back(stem + "." + each.name + "." + type);
  return out;
}

bool RunInstruments::has_frame(const fs::path& folder, const std::string& stem) const {
  for (const ScenarioInstrument& each : scenario_.instruments)
    for (const std::string& type : each.types) {
      const fs::path file = folder / (stem + "." + each.name + "." + type);
      if (!(each.kind == InstrumentKind::lidar ? instruments::is_whole_point_file(file)
                                               : instruments::is_whole_histogram_file(file)))
        return false;
    }
  return true;
}

Json RunInstruments::settings() const {
  Json out = Json::array();
  for (const One& one : all_) {
    const ScenarioInstrument& what = *one.what;
    const Vec3& p = what.mount.translation;
    const Quat& q = what.mount.rotation;
    Json entry{{"name", what.name},
               {what.kind == InstrumentKind::lidar ? "lidar" : "radar", one.text},
               {"types", what.types},
               {"ideal", what.ideal},
               {"position", {p.x, p.y, p.z}},
               {"quat", {q.w, q.x, q.y, q.z}}};
    if (what.kind == InstrumentKind::lidar) entry["frame"] = what.frame;
    if (!one.pulses.empty()) entry["pulses"] = one.pulses;
    out.push_back(std::move(entry));
  }
  return out;
}

bool RunInstruments::is_covered(double time) const {
  if (!moves()) return true;
  for (const One& one : all_) {
    DiagnosticLog apart = log_.apart();
    if (one.span == 0 || workspace::frame_at(scenario_, time + one.span, apart)) continue;
    for (const Diagnostic& each : apart.entries()) {
      const FileId file = each.where.file;
      log_.report_file(each.code, file == kNoFile ? "" : apart.sources().file(file).name,
                       fmt::format("{} measures for {:.6g} s from the frame at {:.9g} s: {}",
                                   one.what->name, one.span, time, each.message),
                       each.hint);
    }
    return false;
  }
  return true;
}

bool RunInstruments::measure(workspace::ViewSession& session, const world::World& world,
                             double time, std::uint64_t number, const fs::path& folder,
                             const std::string& stem) {
  Clock clock(scenario_, session, world, time, number);
  context_.step("measure");
  // what holds for every frame is said once
  DiagnosticLog apart = log_.apart();
  DiagnosticLog& log = warned_ ? apart : log_;
  warned_ = true;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const One& one = all_[i];
    std::vector<std::string> outputs;
    for (const std::string& type : one.what->types)
      outputs.push_back((folder / (stem + "." + one.what->name + "." + type)).string());
    const auto frame = static_cast<std::uint32_t>(number);
    if (one.what->kind == InstrumentKind::lidar ? measure_lidar(one, clock, i, frame, outputs, log)
                                                : measure_radar(one, clock, i, frame, outputs, log))
      continue;
    for (const Diagnostic& each : apart.entries()) {
      const FileId file = each.where.file;
      log_.report_file(each.code, file == kNoFile ? "" : apart.sources().file(file).name,
                       fmt::format("{} at {:.9g} s: {}", one.what->name, time, each.message),
                       each.hint);
    }
    return false;
  }
  return true;
}

bool RunInstruments::measure_lidar(const One& one, Clock& clock, std::uint64_t seed,
                                   std::uint32_t frame, const std::vector<std::string>& outputs,
                                   DiagnosticLog& log) {
  const auto begin = clock.at(0, log);
  if (!begin) return false;
  instruments::LidarMoment first;
  begin->set(one.what->mount, first);
  LidarOptions how;
  how.ideal = one.what->ideal;
  how.seed = begin->noise_seed + seed;
  how.frame = frame;
  how.frame_of = one.frame_of;
  DiagnosticLog later = log.apart();
  if (moves())
    how.motion = [&](double time, instruments::LidarMoment& moment) {
      const auto now = clock.at(time, later);
      if (now) now->set(one.what->mount, moment);
      return now.has_value();
    };
  const auto cloud =
      instruments::measure(one.lidar, first.world, first.pose, how, log, context_.job());
  if (!cloud) {
    for (const Diagnostic& each : later.entries())
      log.report_file(each.code, {}, each.message, each.hint);
    return false;
  }
  for (const std::string& output : outputs)
    if (!instruments::write_points(*cloud, output, workspace::recorded_program(), log))
      return false;
  wrote(outputs, {{"pulses", cloud->pulses.size()}, {"points", cloud->points.size()}},
        counted(cloud->points.size(), "point"));
  return true;
}

bool RunInstruments::measure_radar(const One& one, Clock& clock, std::uint64_t seed,
                                   std::uint32_t frame, const std::vector<std::string>& outputs,
                                   DiagnosticLog& log) {
  const auto middle = clock.at(moves() ? 0.5 * one.span : 0, log);
  if (!middle) return false;
  instruments::RadarMoment moment;
  middle->set(one.what->mount, moment);
  std::optional<instruments::RadarMotion> motion;
  if (moves()) {
    const auto begin = clock.at(0, log), end = clock.at(one.span, log);
    if (!begin || !end) return false;
    motion.emplace(instruments::RadarMotion{moment, moment});
    begin->set(one.what->mount, motion->begin);
    end->set(one.what->mount, motion->end);
  }
  instruments::RadarOptions how;
  how.ideal = one.what->ideal;
  how.seed = middle->noise_seed + seed;
  how.frame = frame;
  const auto histogram = instruments::measure(one.radar, moment, motion ? &*motion : nullptr, how,
                                              log, context_.job());
  if (!histogram) return false;
  const std::string record =
      radar_record("run", one.what->file, how, radar_json(one.radar, *histogram));
  for (const std::string& output : outputs)
    if (!instruments::write_histogram(*histogram, output, record, log)) return false;
  wrote(outputs, {{"ranges", histogram->ranges}, {"speeds", histogram->speeds}},
        fmt::format("{} x {} cells", histogram->ranges, histogram->speeds));
  return true;
}

void RunInstruments::wrote(const std::vector<std::string>& outputs, Json facts,
                           const std::string& words) {
  if (context_.options().json) {
    Json entry{{"outputs", outputs}};
    entry.update(facts);
    context_.result()["measured"].push_back(std::move(entry));
  } else if (!context_.options().quiet) {
    print("{}: {}\n", fmt::format("{}", fmt::join(outputs, ", ")), words);
  }
}

}  // namespace panwright::tools
