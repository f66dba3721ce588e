#include "tools/shared_options.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/text.h"
#include "workspace/budget.h"

namespace panwright::tools {

void declare(Arguments& arguments, CommonOptions& common) {
  constexpr const char* kGroup = "Options of every command";
  arguments.flag("--json", common.json, "Print the result and the diagnostics as one JSON object")
      .group(kGroup);
  arguments.add("--sarif", common.sarif, "Also write the diagnostics to FILE as SARIF 2.1.0")
      .type("FILE")
      .group(kGroup);
  arguments.flag("-q,--quiet", common.quiet, "Suppress notes and the list of files written")
      .group(kGroup);
  arguments.flag("--timings", common.timings, "Print the time of each step").group(kGroup);
  arguments
      .add("--color", common.color,
           "Colours in messages: auto (default: on a terminal unless NO_COLOR is set), always or "
           "never")
      .one_of({"auto", "always", "never"})
      .type("WHEN")
      .group(kGroup);
  arguments.add("-j,--threads", common.threads, "Number of threads (default 0: all cores)")
      .range(0, 1024)
      .type("N")
      .group(kGroup);
}

void declare(Arguments& arguments, CacheOption& cache) {
  arguments.flag("--no-cache", cache.off,
                 "Neither read nor write the cache (~/.cache/panwright) of meshes, levels, foil "
                 "and hidden parts. Results are the same");
}

std::filesystem::path CacheOption::folder() const {
  return off ? std::filesystem::path() : workspace::user_cache_folder();
}

void declare_max_input(Arguments& arguments, std::uint64_t& bytes) {
  arguments.add("--max-input", bytes, "Limit of input size, as 512MB").bytes().type("BYTES");
}

void declare_root(Arguments& arguments, std::string& root) {
  arguments
      .add("--root", root,
           "Folder that must contain files named by the model (default: the model's)")
      .type("DIR");
}

void declare_compress(Arguments& arguments, std::string& form) {
  const auto accepts = [](std::string& text) {
    return pan::storage_form(text) ? std::string() : std::string(pan::kStorageForms);
  };
  arguments
      .add("--compress", form,
           "Compress the file (slower to load; refused by readers of format 1.0). Default form: "
           "lossless. lossy:BITS rounds coordinates to that number of bits (8 to 24, default 16) "
           "and prints the error")
      .type("FORM")
      .bare_value("lossless")
      .some_of({"none", "lossless", "lossy", "lossy:11", "lossy:14"}, accepts);
}

pan::StorageForm storage_of(const std::string& form) {
  return pan::storage_form(form).value_or(pan::StorageForm{});
}

std::string storage_words(const std::string& form, const compiler::StorageReport& report) {
  const pan::StorageForm storage = storage_of(form);
  if (!storage.streams()) return {};
  std::string out =
      fmt::format(", stored as {}: vertices moved by {:.3g} m, normals by {:.3g} deg at most",
                  pan::storage_name(storage), report.position_error, report.normal_error / kDegree);
  if (report.meshes_with_more_bits > 0)
    out += fmt::format("; {} with more bits, for the tolerance",
                       report.meshes_with_more_bits == 1
                           ? "1 mesh"
                           : fmt::format("{} meshes", report.meshes_with_more_bits));
  return out;
}

nlohmann::ordered_json storage_json(const std::string& form,
                                    const compiler::StorageReport& report) {
  return {{"form", pan::storage_name(storage_of(form))},
          {"bytes", report.bytes},
          {"position_error", report.position_error},
          {"normal_error", report.normal_error / kDegree},
          {"meshes_with_more_bits", report.meshes_with_more_bits}};
}

void declare(Arguments& arguments, ReadOptions& read) {
  declare_root(arguments, read.open.root);
  arguments
      .add("-D,--define", read.parameters,
           "Set a <param> of the model, as -D span=2.4m; may be repeated")
      .type("NAME=VALUE")
      .one_value();
  declare_max_input(arguments, read.open.max_input);
  arguments
      .add("--max-error", read.open.max_error,
           "Largest distance between mesh and shape, metres, in place of the model's budget "
           "(default: the budget, or 0.001)")
      .length()
      .positive()
      .type("METRES");
  arguments
      .add("--budget", read.open.budget,
           "Accuracy budget in place of the model's: any of nearest=5km ifov=0.1mrad pixels=0.25 "
           "flux=0.1% centroid=0.01px approach=FRAME; or none")
      .type("TERMS");
  arguments.add("--max-triangles", read.open.max_triangles, "Limit of triangles in the file")
      .range(1.0, 1e12)
      .type("N");
}

Result<workspace::OpenOptions> ReadOptions::opening(DiagnosticLog& log) const {
  workspace::OpenOptions out = open;
  out.cache = cache.folder();
  if (!open.budget.empty() && !workspace::budget_of_text(open.budget, log)) return failed;
  for (const std::string& parameter : parameters) {
    const std::size_t sign = parameter.find('=');
    if (sign == std::string::npos || sign == 0) {
      log.report(
          Code("E0201"), {},
          fmt::format("-D {}: NAME=VALUE is needed, as in -D span=2.4m", in_quotes(parameter)));
      return failed;
    }
    out.parameters.emplace_back(parameter.substr(0, sign), parameter.substr(sign + 1));
  }
  return out;
}

void declare(Arguments& arguments, workspace::CadOptions& cad) {
  constexpr const char* kGroup = "CAD files";
  const auto option = [&](const char* name, auto& value, const char* type, const char* help) {
    return arguments.add(name, value, help).type(type).group(kGroup);
  };
  option("--units", cad.units, "UNIT",
         "Length of 1 in the file: auto (default), m, mm, cm, dm, km, um, in or ft")
      .one_of({"auto", "m", "mm", "cm", "dm", "km", "um", "in", "ft"});
  // not "--up", which is the camera's
  option("--up-axis", cad.up, "AXIS",
         "Up axis of the file: y or z (default auto: z in STL, PLY and STEP, else y)")
      .one_of({"auto", "y", "z"});
  arguments.flag("--keep-hidden", cad.keep_hidden, "Keep faces that are not visible from outside")
      .group(kGroup);
  const Argument no_weld =
      arguments.flag("--no-weld", cad.no_weld, "Disable the clean-up of meshes").group(kGroup);
  option("--weld", cad.weld, "METRES",
         "Largest distance of vertices to weld (default 0: equal positions)")
      .length()
      .not_negative()
      .excludes(no_weld);
  option("--crease", cad.crease_deg, "DEG",
         "Largest angle of smooth edges between faces without normals (default 30)")
      .angle()
      .range(0.0, 180.0);
  arguments
      .flag("--crease-normals", cad.crease_normals,
            "Recompute all normals with the crease angle, not only missing ones")
      .excludes(no_weld)
      .group(kGroup);
  option("--scene", cad.scene, "NAME|N", "glTF: scene to read (default: the file's own)");
  option("--animation", cad.animation, "NAME|N|none",
         "glTF: animation that poses the nodes (default: all, at the first frame where nodes are "
         "displaced without it)");
  option("--time", cad.time, "SECONDS", "glTF: time of the pose (default: the first frame)")
      .finite();
  option("--primitives", cad.primitives, "N",
         "VRML: segments around spheres, cylinders and cones (default 0: exact shapes)")
      .range(0u, 100000u);
  option("--deflection", cad.deflection, "METRES",
         "STEP: largest distance of triangles from their surfaces (default 0: 1e-4 of the model's "
         "size)")
      .length()
      .not_negative();
  option("--max-seconds", cad.max_seconds, "SECONDS",
         "STEP: limit of processor time (default 600); the limit of elapsed time is four times as "
         "long")
      .finite()
      .positive();
  option("--assume", cad.assume, "KIND",
         "Format to assume when it cannot be detected: vrml97, vrml1, gltf, obj, stl, ply, step, "
         "urdf or mjcf")
      .one_of({"vrml97", "vrml1", "gltf", "obj", "stl", "ply", "step", "urdf", "mjcf"});
  arguments.flag("--recentre", cad.recentre, "Move the centre of the model to the origin")
      .group(kGroup);
}

void declare(Arguments& arguments, ViewOptions& options, workspace::SettingId id) {
  const workspace::SettingInfo& info = workspace::info_of(id);
  const auto at = static_cast<std::size_t>(id);
  if (*info.option == '\0') return;
  if (id == workspace::SettingId::joint) return declare(arguments, options.joints);
  if (*info.metavar == '\0') {
    arguments.flag(info.option, options.flags[at], info.help).group(info.section);
    return;
  }
  std::vector<std::string>* repeated = id == workspace::SettingId::pose     ? &options.poses
                                       : id == workspace::SettingId::lamp   ? &options.lamps
                                       : id == workspace::SettingId::planet ? &options.planets
                                                                            : nullptr;
  Argument argument = repeated ? arguments.add(info.option, *repeated, info.help).one_value()
                               : arguments.add(info.option, options.texts[at], info.help);
  argument.type(info.metavar).group(info.section).some_of(info.words);
  if ((info.flags & workspace::kSeveral) != 0) argument.numbers();
}

void declare(Arguments& arguments, JointOptions& options) {
  const workspace::SettingInfo& info = workspace::info_of(workspace::SettingId::joint);
  arguments.add(info.option, options.values, info.help)
      .type(info.metavar)
      .one_value()
      .group(info.section);
  arguments
      .add("--joints", options.file,
           "JSON object of joint values by name, as {\"wing\": \"30deg\"}")
      .type("FILE.json")
      .group(info.section);
}

Result<std::vector<workspace::JointText>> JointOptions::texts(DiagnosticLog& log) const {
  std::vector<workspace::JointText> out;
  if (!file.empty()) {
    auto read = workspace::read_joints(file, log);
    if (!read) return failed;
    out = *std::move(read);
  }
  std::set<std::string> typed;
  for (const std::string& value : values) {
    out.push_back(workspace::joint_text(value));
    if (typed.insert(out.back().joint).second) continue;
    log.report(Code("E0201"), {},
               fmt::format("--joint gives {} a value twice", in_quotes(out.back().joint)));
    return failed;
  }
  return out;
}

Result<workspace::Settings> ViewOptions::settings(DiagnosticLog& log) const {
  using workspace::SettingId;
  workspace::Settings out;
  auto given_joints = joints.texts(log);
  bool good = given_joints.ok();
  if (good && !given_joints->empty()) out.joint = *std::move(given_joints);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto id = static_cast<SettingId>(i);
    if (texts[i]) good = workspace::read_setting(id, *texts[i], out, log) && good;
    if (flags[i]) good = workspace::read_setting(id, "true", out, log) && good;
  }
  for (const std::string& lamp : lamps)
    good = workspace::read_setting(SettingId::lamp, lamp, out, log) && good;
  for (const std::string& planet : planets)
    good = workspace::read_setting(SettingId::planet, planet, out, log) && good;
  std::set<std::string> targets;
  for (const std::string& pose : poses) {
    good = workspace::read_setting(SettingId::pose, pose, out, log) && good;
    const std::string target = pose.substr(0, pose.find('=') + 1);  // npos + 1 is 0
    if (targets.insert(target).second) continue;
    log.report(Code("E0201"), {},
               target.empty() ? "--pose is given twice without the name of a target"
                              : fmt::format("--pose is given twice for {}",
                                            in_quotes(target.substr(0, target.size() - 1))));
    return failed;
  }
  if (!good) return failed;
  return out;
}

}  // namespace panwright::tools
