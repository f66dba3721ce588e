// Look-ups, LiDARs and RADARs.
#include <algorithm>
#include <filesystem>
#include <optional>

#include "base/file.h"
#include "instruments/lidar.h"
#include "instruments/lookup.h"
#include "instruments/radar.h"
#include "python/bindings.h"
#include "python/model.h"
#include "workspace/frame.h"

namespace panwright::python {

namespace {

using instruments::LidarPoint;
using instruments::SurfacePoint;
using Targets = std::vector<std::pair<std::string, Model>>;

world::World world_of(const Targets& targets) {
  DiagnosticLog log;
  world::World world;
  for (const auto& [name, model] : targets) (void)world.add(name, model.model, log);
  settle(log);
  return world;
}

// The world as a view shows it, and its camera.
struct Shown {
  world::World world;
  workspace::Frame frame;
};

Shown shown_by(const world::World& world, const workspace::View& view) {
  DiagnosticLog log;
  auto frame = workspace::FrameMaker(world).frame(view, log);
  settle(log);
  Shown out{world, *std::move(frame)};
  workspace::show(out.frame, world, out.world);
  return out;
}

template <class T, class List, class Get>
py::array_t<T> column(const List& list, const Get& get) {
  py::array_t<T> out(static_cast<py::ssize_t>(list.size()));
  T* to = out.mutable_data();
  for (const auto& each : list) *to++ = static_cast<T>(get(each));
  return out;
}

template <class List, class Get>
py::array_t<double> vectors(const List& list, const Get& get) {
  py::array_t<double> out({static_cast<py::ssize_t>(list.size()), py::ssize_t{3}});
  double* to = out.mutable_data();
  for (const auto& each : list) {
    const Vec3 v = get(each);
    for (int k = 0; k < 3; ++k) *to++ = v[k];
  }
  return out;
}

// NaN where nothing was found.
py::dict surfaces(const std::vector<SurfacePoint>& found) {
  constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();
  using P = SurfacePoint;
  const auto vector_of = [&](Vec3 P::*member) {
    return vectors(found, [&](const P& p) { return p ? p.*member : Vec3(kAbsent); });
  };
  py::dict out;
  out["distance"] = column<double>(found, [](const P& p) { return p.distance; });
  out["position"] = vector_of(&P::position);
  out["in_model"] = vector_of(&P::in_model);
  out["facet"] = vector_of(&P::facet);
  out["normal"] = vector_of(&P::normal);
  out["target_id"] = column<std::uint32_t>(found, [](const P& p) { return p.ids.target; });
  out["node_id"] = column<std::uint32_t>(found, [](const P& p) { return p.ids.node; });
  out["material_id"] = column<std::uint32_t>(found, [](const P& p) { return p.ids.material; });
  out["instance_id"] = column<std::uint32_t>(found, [](const P& p) { return p.ids.instance; });
  return out;
}

class LookupsOf {
 public:
  LookupsOf(const Targets& targets, const workspace::View& view, std::size_t threads)
      : world_(world_of(targets)), threads_(threads) {
    update(view);
  }

  void update(const workspace::View& view) {
    Shown shown = shown_by(world_, view);
    camera_ = shown.frame.camera();
    const Job job({threads_, {}});
    without_gil(job, [&] { lookups_.update(shown.world, job); });
  }

  py::dict rays(const Numbers& origins, const Numbers& directions) {
    const std::size_t count = rows_of(origins, 3, "origins");
    if (rows_of(directions, 3, "directions") != count)
      throw py::value_error("origins and directions have different lengths");
    std::vector<geometry::Ray> rays(count);
    for (std::size_t i = 0; i < count; ++i) {
      rays[i].origin = vec3(origins, i);
      const Vec3 along = vec3(directions, i);
      const double length = glm::length(along);
      if (!(length > 0) || !std::isfinite(length))
        throw py::value_error("directions have a row without a direction");
      rays[i].direction = along / length;
    }
    return found(count, [&](std::vector<SurfacePoint>& out, const Job& job) {
      lookups_.rays(rays, out, job);
    });
  }

  py::dict pixels(const Numbers& places) {
    const auto asked = pairs(places, "places");
    return found(asked.size(), [&](std::vector<SurfacePoint>& out, const Job& job) {
      lookups_.pixels(camera_, asked, out, job);
    });
  }

  py::dict elevations(const Numbers& places) {
    const auto asked = pairs(places, "places");
    return found(asked.size(), [&](std::vector<SurfacePoint>& out, const Job& job) {
      lookups_.elevations(asked, out, job);
    });
  }

  py::dict nearest(const Numbers& points) {
    const std::size_t count = rows_of(points, 3, "points");
    std::vector<Vec3> asked(count);
    for (std::size_t i = 0; i < count; ++i) asked[i] = vec3(points, i);
    return found(count, [&](std::vector<SurfacePoint>& out, const Job& job) {
      lookups_.nearest(asked, out, job);
    });
  }

  py::array_t<bool> sights(const Numbers& from, const Numbers& to, double slack) {
    const std::size_t count = rows_of(from, 3, "start");
    if (rows_of(to, 3, "end") != count)
      throw py::value_error("start and end have different lengths");
    if (!(slack >= 0)) throw py::value_error("slack is below 0");
    std::vector<instruments::Sight> asked(count);
    for (std::size_t i = 0; i < count; ++i) asked[i] = {vec3(from, i), vec3(to, i)};
    std::vector<std::uint8_t> open(count);
    const Job job({threads_, {}});
    without_gil(job, [&] { lookups_.sights(asked, slack, open, job); });
    return column<bool>(open, [](std::uint8_t each) { return each != 0; });
  }

  py::dict keypoints(double slack) const {
    py::dict out;
    const auto all = lookups_.keypoints(camera_, slack);
    for (std::size_t i = 0; i < all.size(); ++i)
      out[py::str(lookups_.world()[i].name())] = py::cast(all[i]);
    return out;
  }

 private:
  static Vec3 vec3(const Numbers& from, std::size_t row) {
    const double* at = from.data() + 3 * row;
    const Vec3 out(at[0], at[1], at[2]);
    if (!is_finite(out)) throw py::value_error("coordinates are not finite");
    return out;
  }

  static std::vector<Vec2> pairs(const Numbers& from, const char* name) {
    std::vector<Vec2> out(rows_of(from, 2, name));
    const double* at = from.data();
    for (Vec2& each : out) {
      each = {at[0], at[1]};
      at += 2;
      if (!std::isfinite(each.x) || !std::isfinite(each.y))
        throw py::value_error("coordinates are not finite");
    }
    return out;
  }

  template <class Ask>
  py::dict found(std::size_t count, const Ask& ask) const {
    std::vector<SurfacePoint> out(count);
    const Job job({threads_, {}});
    without_gil(job, [&] { ask(out, job); });
    DiagnosticLog log;
    lookups_.report_damaged(log);
    settle(log);
    return surfaces(out);
  }

  world::World world_;
  std::size_t threads_ = 0;
  instruments::Lookups lookups_;
  world::Camera camera_;
};

py::dict arrays_of(const instruments::LidarCloud& cloud) {
  using P = LidarPoint;
  const auto& points = cloud.points;
  py::dict out;
  out["position"] = vectors(points, [](const P& p) { return p.position; });
  out["range"] = column<double>(points, [](const P& p) { return p.range; });
  out["intensity"] = column<double>(points, [](const P& p) { return p.intensity; });
  out["reflectance"] = column<double>(points, [](const P& p) { return p.reflectance; });
  out["time"] = column<double>(points, [](const P& p) { return p.time; });
  out["pulse"] = column<std::uint32_t>(points, [](const P& p) { return p.pulse; });
  out["echo"] = column<std::uint8_t>(points, [](const P& p) { return p.echo; });
  out["echoes"] = column<std::uint8_t>(points, [](const P& p) { return p.echoes; });
  out["flags"] = column<std::uint8_t>(points, [](const P& p) { return p.flags; });
  out["true_range"] = column<double>(points, [](const P& p) { return p.true_range; });
  out["share"] = column<double>(points, [](const P& p) { return p.share; });
  out["cosine"] = column<double>(points, [](const P& p) { return p.cosine; });
  out["target_id"] = column<std::uint32_t>(points, [](const P& p) { return p.ids.target; });
  out["node_id"] = column<std::uint32_t>(points, [](const P& p) { return p.ids.node; });
  out["material_id"] = column<std::uint32_t>(points, [](const P& p) { return p.ids.material; });
  out["instance_id"] = column<std::uint32_t>(points, [](const P& p) { return p.ids.instance; });
  using instruments::Pulse;
  out["pulse_direction"] = vectors(cloud.pulses, [](const Pulse& p) { return p.direction; });
  out["pulse_time"] = column<double>(cloud.pulses, [](const Pulse& p) { return p.time; });
  out["pulse_row"] = column<std::uint32_t>(cloud.pulses, [](const Pulse& p) { return p.row; });
  out["pulse_column"] =
      column<std::uint32_t>(cloud.pulses, [](const Pulse& p) { return p.column; });
  out["pulse_status"] =
      column<std::uint8_t>(cloud.status, [](instruments::PulseStatus s) { return s; });
  py::array_t<double> poses({static_cast<py::ssize_t>(cloud.poses.size()), py::ssize_t{7}});
  double* to = poses.mutable_data();
  for (const world::Pose& pose : cloud.poses)
    for (const double each : {pose.translation.x, pose.translation.y, pose.translation.z,
                              pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
      *to++ = each;
  out["world_from_instrument"] = poses;
  return out;
}

py::dict lidar(const Targets& targets, const workspace::View& view,
               const std::filesystem::path& file, const std::string& frame, bool ideal,
               std::size_t threads) {
  constexpr std::uint64_t kMostBytes = 1 << 20;
  const Shown shown = shown_by(world_of(targets), view);
  DiagnosticLog log;
  Result<instruments::Lidar> lidar = failed;
  if (const auto text = read_file(file, kMostBytes, log))
    lidar = instruments::read_lidar(*text, file.string(), file.parent_path(), log);
  instruments::LidarOptions options;
  options.ideal = ideal;
  options.seed = *shown.frame.settings.noise_seed;
  options.frame = *shown.frame.settings.frame_number;
  if (frame == "world") options.frame_of = instruments::LidarOptions::kWorld;
  if (frame != "world" && frame != "instrument")
    if (const auto target = shown.world.require(frame, log))
      options.frame_of = static_cast<std::int32_t>(*target);
  settle(log);
  Result<instruments::LidarCloud> cloud = failed;
  const Job job({threads, {}});
  const world::Camera& camera = shown.frame.camera();
  without_gil(job, [&] {
    cloud = instruments::measure(*lidar, shown.world, {camera.position, camera.world_from_camera},
                                 options, log, job);
  });
  settle(log);
  return arrays_of(*cloud);
}

using Motion = std::optional<std::pair<workspace::View, workspace::View>>;

py::array_t<double> plane_of(const instruments::RadarHistogram& h,
                             const std::vector<double>& values) {
  py::array_t<double> out({static_cast<py::ssize_t>(h.speeds), static_cast<py::ssize_t>(h.ranges)});
  std::ranges::copy(values, out.mutable_data());
  return out;
}

py::array_t<double> axis_of(double first, double step, std::uint32_t count) {
  py::array_t<double> out(static_cast<py::ssize_t>(count));
  for (std::uint32_t i = 0; i < count; ++i) out.mutable_data()[i] = first + step * i;
  return out;
}

py::dict arrays_of(const instruments::RadarHistogram& h) {
  py::dict out;
  out["power_w"] = plane_of(h, h.power);
  out["mean_power_w"] = plane_of(h, h.mean_power);
  out["azimuth_rad"] = plane_of(h, h.azimuth);
  out["elevation_rad"] = plane_of(h, h.elevation);
  out["range_m"] = axis_of(h.first_range, h.range_step, h.ranges);
  out["speed_m_s"] = axis_of(h.first_speed, h.speed_step, h.speeds);
  out["response_sum"] = h.response_sum;
  out["noise_w"] = h.noise;
  out["gain"] = h.gain;
  out["echo_power_w"] = h.echo_power;
  out["outside"] = h.outside;
  py::dict targets;
  for (const instruments::RadarTarget& each : h.targets) {
    py::dict target;
    target["cross_section_m2"] = each.cross_section;
    target["range_m"] = each.range;
    target["speed_m_s"] = each.speed;
    targets[py::str(each.name)] = target;
  }
  out["targets"] = targets;
  out["altitude_m"] = h.altitude ? py::cast(*h.altitude) : py::none();
  return out;
}

py::dict radar(const Targets& targets, const workspace::View& view, const Motion& motion,
               const std::filesystem::path& file, bool ideal, std::size_t threads) {
  constexpr std::uint64_t kMostBytes = 1 << 20;
  const world::World world = world_of(targets);
  const auto moment_of = [&](const workspace::View& of, workspace::Settings* settings) {
    const Shown shown = shown_by(world, of);
    if (settings != nullptr) *settings = shown.frame.settings;
    const world::Camera& camera = shown.frame.camera();
    return instruments::RadarMoment{shown.world, {camera.position, camera.world_from_camera}};
  };
  workspace::Settings settings;
  const instruments::RadarMoment moment = moment_of(view, &settings);
  std::optional<instruments::RadarMotion> moving;
  if (motion)
    moving.emplace(instruments::RadarMotion{moment_of(motion->first, nullptr),
                                            moment_of(motion->second, nullptr)});
  DiagnosticLog log;
  Result<instruments::Radar> radar = failed;
  if (const auto text = read_file(file, kMostBytes, log))
    radar = instruments::read_radar(*text, file.string(), log);
  settle(log);
  instruments::RadarOptions options;
  options.ideal = ideal;
  options.seed = *settings.noise_seed;
  options.frame = *settings.frame_number;
  Result<instruments::RadarHistogram> found = failed;
  const Job job({threads, {}});
  without_gil(job, [&] {
    found = instruments::measure(*radar, moment, moving ? &*moving : nullptr, options, log, job);
  });
  settle(log);
  return arrays_of(*found);
}

}  // namespace

void bind_instruments(py::module_& module) {
  py::class_<LookupsOf>(module, "Lookups")
      .def(py::init<const Targets&, const workspace::View&, std::size_t>(), py::arg("targets"),
           py::arg("view"), py::arg("threads"))
      .def("update", &LookupsOf::update, py::arg("view"))
      .def("rays", &LookupsOf::rays, py::arg("origins"), py::arg("directions"))
      .def("pixels", &LookupsOf::pixels, py::arg("places"))
      .def("elevations", &LookupsOf::elevations, py::arg("places"))
      .def("nearest", &LookupsOf::nearest, py::arg("points"))
      .def("sights", &LookupsOf::sights, py::arg("start"), py::arg("end"), py::arg("slack"))
      .def("keypoints", &LookupsOf::keypoints, py::arg("slack"));
  module.def("lidar", &lidar, py::arg("targets"), py::arg("view"), py::arg("file"),
             py::arg("frame"), py::arg("ideal"), py::arg("threads"));
  module.def("radar", &radar, py::arg("targets"), py::arg("view"), py::arg("motion"),
             py::arg("file"), py::arg("ideal"), py::arg("threads"));
}

}  // namespace panwright::python
