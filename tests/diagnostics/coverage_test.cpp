// Every code of the registry is produced by the program on some input: pxn codes by the files of
// tests/pxn/data/bad (named after their code), pan codes by damaged files, the others by the
// command lines below.

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/diagnostic.h"
#include "tests/support/pan_damage.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/sanitizers.h"

namespace panwright::coverage_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using support::TemporaryFolder;

const std::string kFigure8 = PANWRIGHT_SOURCE_DIR "/examples/paper/figure8.pxn";
const std::string kCrater = PANWRIGHT_SOURCE_DIR "/examples/terrain/crater.lbl";
const std::string kLabels = PANWRIGHT_SOURCE_DIR "/examples/labels";
const fs::path kBad = PANWRIGHT_SOURCE_DIR "/tests/pxn/data/bad";
const fs::path kBadCad = PANWRIGHT_SOURCE_DIR "/tests/importers/data/bad";

// The codes that a run of the program reports; its exit code must agree with them.
std::set<std::string> codes_of(std::vector<std::string> words,
                               const std::vector<std::string>& environment = {}) {
  words.insert(words.begin(), PANWRIGHT_BIN_DIR "/panwright");
  words.push_back("--json");
  const support::Outcome outcome = support::run(words, environment);
  const json out = json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(out.is_discarded())
      << words[1] << " " << words[2] << ": " << outcome.out << outcome.err;
  std::set<std::string> codes;
  if (out.is_discarded()) return codes;
  EXPECT_EQ(out["errors"].get<int>() > 0, outcome.code != 0);
  for (const auto& item : out["diagnostics"]) codes.insert(item["code"].get<std::string>());
  return codes;
}

// The code that a file of tests/pxn/data/bad is named after.
std::string code_in(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.substr(0, name.find_first_of("-."));
}

// More targets than a world may have.
std::vector<std::string> crowd(const std::string& pan) {
  std::vector<std::string> words{"render"};
  for (int i = 0; i <= 4096; ++i) words.push_back(std::to_string(i) + "=" + pan);
  return words;
}

// A pan file whose only tile has a wrong byte.
// Heights of two by two pixels, without a map.
std::string bare_header(const TemporaryFolder& folder) {
  (void)folder.write("bare.dat", std::string("\1\2\3\4", 4));
  return folder.write("bare.hdr", "ENVI\nsamples = 2\nlines = 2\nbands = 1\ndata type = 1\n");
}

std::string terrain_of(const TemporaryFolder& folder, const std::string& name) {
  codes_of({"dem", kCrater, "-o", folder / name});
  return folder / name;
}

// A text that takes a part of the crater.
std::string terrain_text(const TemporaryFolder& folder, const std::string& name,
                         const std::string& attributes) {
  for (const char* extension : {".lbl", ".img"})
    fs::copy_file(fs::path(kCrater).replace_extension(extension),
                  folder.path() / (std::string("crater") + extension),
                  fs::copy_options::overwrite_existing);
  return folder.write(name, "<pangu_model ver=\"1\"><terrain><dem file=\"crater.lbl\" " +
                                attributes + "/></terrain></pangu_model>");
}

std::string damaged_terrain(const TemporaryFolder& folder) {
  const std::string path = terrain_of(folder, "ground.pan");
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(5000);
  file.put('\x55');
  return path;
}

struct Trigger {
  std::string code;
  std::vector<std::string> words;
  std::vector<std::string> environment;
};

std::vector<Trigger> command_lines(const TemporaryFolder& folder) {
  fs::create_symlink("/proc/self/mem", folder.path() / "unreadable.pxn");
  const std::string view = folder.write("v.json", "[{\"fof\": 1, \"output\": \"a.png\"}]");
  const std::string pan = folder / "f.pan";
  codes_of({"compile", kFigure8, "-o", pan});
  const std::string png = folder / "f.png";
  const auto model = [](const std::string& nodes) {
    return "<pangu_model ver=\"0\">" + nodes + "</pangu_model>";
  };
  const auto vec3 = [](const std::string& tag, const std::string& numbers) {
    return "<" + tag + "><vec3>" + numbers + "</vec3></" + tag + ">";
  };
  const std::string braces =
      folder.write("braces.pxn", model("<frame_s label=\"a{1}\">" + vec3("origin", "0 0 0") +
                                       vec3("forward", "0 0 1") + vec3("up", "0 -1 0") +
                                       vec3("right", "1 0 0") + "</frame_s>"));
  const std::string changed =
      folder.write("changed.pxn", "<pangu_model ver=\"1\"><sphere/></pangu_model>");
  codes_of({"render", changed, "-o", folder / "changed.png", "--engine", "reference", "--size",
            "8x8", "--samples", "1"});
  folder.write("changed.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>");
  fs::create_directories(folder.path() / "parts");
  const std::string whole =
      folder.write("whole.pxn", model("<include type=\"pxn\" file=\"parts/part.pxn\"/>"));
  const std::string part =
      folder.write("parts/part.pxn", model("<include type=\"pxn\" file=\"ball.pxn\"/>"));
  folder.write("ball.pxn", model("<sphere rings=\"3\" quads=\"3\"/>"));
  folder.write("white.ppm", std::string("P6\n1 1\n255\n\xff\xff\xff", 14));
  const std::string inwards =
      folder.write("inwards.pxn",
                   "<pangu_model ver=\"1\"><box name=\"b\" size=\"2\"/><decal on=\"b\" "
                   "image=\"white.ppm\" at=\"0 0 1\" normal=\"0 0 -1\" size=\"1\"/></pangu_model>");
  // Oren and Nayar's law of 1994 reflects up to 1.04 of the light at albedo 1
  const std::string chalk =
      folder.write("chalk.pxn",
                   "<pangu_model ver=\"1\"><material name=\"chalk\"><diffuse>1 1 1</diffuse>"
                   "<oren>0.3rad</oren></material><sphere material=\"chalk\"/></pangu_model>");
  const std::string jointed = folder.write(
      "jointed.pxn",
      "<pangu_model ver=\"1\"><joint name=\"drive\" type=\"revolute\" lower=\"0\" upper=\"90\" "
      "pointing=\"1 0 0\"><sphere/></joint></pangu_model>");
  const std::string nested = [] {
    std::string text = "#VRML V2.0 utf8\n";
    for (int i = 0; i < 2000; ++i) text += "Group { children [ ";
    return text;
  }();
  const std::string camera_file = folder.write("camera.toml", "size = 8\nfocal = -1\n");
  const std::string two_cameras =
      folder.write("camchain.yaml",
                   "cam0: {intrinsics: [9, 9, 4, 4], resolution: [8, 8]}\n"
                   "cam1: {intrinsics: [9, 9, 4, 4], resolution: [8, 8]}\n");
  const auto table = [&](const char* name, const std::string& rows) {
    return folder.write(name, "time[s],camera.x[m],camera.y[m],camera.z[m]\n" + rows);
  };
  const auto turned = [&](const char* name, const std::string& row) {
    return folder.write(name,
                        "time[s],camera.qw[world_from_camera],camera.qx[world_from_camera],"
                        "camera.qy[world_from_camera],camera.qz[world_from_camera]\n" +
                            row);
  };
  const std::string course = table("course.csv", "0,0,-9,0\n1,0,-8,0\n");
  const auto oem = [&](const char* name, const std::string& members, const std::string& records) {
    return folder.write(name,
                        "CCSDS_OEM_VERS = 2.0\nCREATION_DATE = 2026-01-01T00:00:00\n"
                        "ORIGINATOR = T\nMETA_START\nOBJECT_NAME = A\nOBJECT_ID = 1\n"
                        "CENTER_NAME = EARTH\nREF_FRAME = EME2000\n" +
                            members +
                            "START_TIME = 2026-01-01T00:00:00\n"
                            "STOP_TIME = 2026-01-01T00:01:00\nMETA_STOP\n" +
                            records);
  };
  const std::string records =
      "2026-01-01T00:00:00 7000 0 0 0 7.5 0\n2026-01-01T00:01:00 6990 450 0 -0.5 7.5 0\n";
  const std::string twice = folder.write(
      "twice.toml", "[[source]]\nfile = \"course.csv\"\n[[source]]\nfile = \"course.csv\"\n");
  const std::string order =
      folder.write("order.csv", "camera.x[m],camera.y[m],camera.z[m]\n0,0,0\n");
  const std::string mixed = folder.write(
      "mixed.toml", "[[source]]\nfile = \"order.csv\"\n[[source]]\nfile = \"turn.csv\"\n");
  turned("turn.csv", "0,1,0,0,0\n1,1,0,0,0\n");
  const std::string scene = folder.write("run.toml", "[[source]]\nfile = \"course.csv\"\n");
  const std::vector<std::string> run = {"run",    scene,          "--target",  "f=" + pan,
                                        "-o",     folder / "run", "--engine",  "reference",
                                        "--size", "4x4",          "--samples", "1"};
  codes_of(run);
  folder.write("torn.labels.json", "{");
  const auto with_kernel = [&](const std::string& name, const std::string& text) {
    folder.write(name, text);
    return folder.write(name + ".toml", "[[source]]\nkernels = \"" + name +
                                            "\"\nbody = -99\nobserver = \"EARTH\"\n");
  };
  const auto detector = [&](const char* name, const std::string& members,
                            const std::string& aperture = "10") {
    return folder.write(name, "size = 8\nfocal = 8\n[optics]\naperture_mm = " + aperture +
                                  "\n[detector]\npixel_um = 5\n" + members);
  };
  const auto sky_of = [&](const std::string& map, const std::string& key = "map=") {
    return std::vector<std::string>{
        "render",    pan, "-o",       png,         "--size",   "4x4",
        "--samples", "1", "--engine", "reference", "--planet", "earth=0 0 -6778km " + key + map};
  };
  std::vector<Trigger> triggers = {
      {"E0220", {"render", pan, "-o", png, "--camera-file", camera_file}, {}},
      {"W0221",
       {"render", pan, "-o", png, "--camera-file", two_cameras, "--engine", "reference"},
       {}},
      {"E0261",
       {"lidar", pan, "--lidar", folder.write("lidar.toml", "[scan]\npattern = \"wave\"\n"), "-o",
        folder / "cloud.npz"},
       {}},
      {"E0262", {"lookup", pan, "--nearest", folder.write("points.csv", "1,2,3\n1,x\n")}, {}},
      {"W0222",
       {"camera", detector("coarse.toml", "exposure_s = 1\nread_noise_e = 2\ndn_per_e = 0.1\n")},
       {}},
      {"E0263",
       {"radar", pan, "--radar", folder.write("bad_radar.toml", "[signal]\n"), "-o", png},
       {}},
      {"W0264",
       {"radar", pan, "--radar",
        folder.write("bare_radar.toml",
                     "[signal]\nfrequency_hz = 1e10\nbandwidth_hz = 1e8\ndwell_s = 0.01\n"
                     "[antenna]\nbeam_deg = [10, 10]\n"
                     "[histogram]\nrange_m = [0, 20]\nspeed_m_s = [-1, 1]\nrays = 8\n"),
        "-o", png},
       {}},
      {"W5017",
       {"render", pan, "-o", png, "--camera-file",
        detector("bright.toml", "exposure_s = 1e5\n", "1e6"), "--sun-irradiance", "1e20",
        "--engine", "reference", "--samples", "1"},
       {}},
      {"W5018",
       {"render", pan, "-o", png, "--camera-file", detector("auto.toml", "exposure_s = \"auto\"\n"),
        "--camera", "0 -9 0", "--look-at", "0 -10 0", "--engine", "reference", "--samples", "1"},
       {}},
      {"W5019",
       {"render", pan, "-o", png, "--engine", "reference", "--samples", "1", "--size", "8x8",
        "--lamp", "point at 0 0 9 intensity 1 pulse 1 2"},
       {}},
      {"E8001", {"scenario", table("word.csv", "0,one,0,0\n")}, {}},
      {"W8002", {"scenario", folder.write("more.csv", "time[s],camera.colour[1]\n0,1\n")}, {}},
      {"E8003", {"scenario", course, "--at", "9"}, {}},
      {"E8004", {"scenario", table("back.csv", "1,0,0,0\n0,0,0,0\n")}, {}},
      {"E8005", {"scenario", turned("zero.csv", "0,0,0,0,0\n")}, {}},
      {"W8006", {"scenario", turned("rough.csv", "0,0.7,0.7,0,0\n")}, {}},
      {"E8007", {"scenario", oem("ut1.oem", "TIME_SYSTEM = UT1\n", records)}, {}},
      {"E8008", {"scenario", twice}, {}},
      {"E8009", {"scenario", mixed}, {}},
      {"N8010", {"scenario", oem("plain.oem", "TIME_SYSTEM = UTC\n", records)}, {}},
      {"W8011",
       {"scenario", table("gap.csv", "0,0,0,0\n1,0,0,0\n2,0,0,0\n3,0,0,0\n99,0,0,0\n")},
       {}},
      {"W8012",
       {"scenario", oem("again.oem", "TIME_SYSTEM = UTC\n",
                        records + "2026-01-01T00:01:00 6990 450 0 -0.5 7.5 0\n")},
       {}},
      {"E8013", {"scenario", folder.write("wrong.toml", "surce = 1\n")}, {}},
      {"E8014", run, {}},
      {"E5040",
       {"stars", "--fov", "10", "--look-at", "1 0 0", "--stars", "8", "--star-catalogue",
        folder.write("no.csv", "x\n")},
       {}},
      {"W5041",
       {"stars", "--fov", "10", "--look-at", "1 0 0", "--stars", "8", "--star-catalogue",
        folder.write("torn.csv", "ra[deg],dec[deg],v[mag]\n1,2,3\nx\n")},
       {}},
      {"N5042",
       sky_of(folder.write("wide.ppm", "P6 4098 2049 255\n" + std::string(3 * 4098 * 2049, 'a'))),
       {}},
      {"W5043",
       sky_of(folder.write("bright.ppm", "P3 2 1 255 255 255 255 255 255 255\n"), "clouds="),
       {}},
      {"E8015", {"scenario", with_kernel("open.tls", "KPL/LSK\n\\begindata\nA = ( 1\n")}, {}},
      {"W8016",
       {"scenario",
        with_kernel("elements.xsp",
                    "DAFETF NAIF DAF ENCODED TRANSFER FILE\n'DAF/SPK '\n'2'\n'6'\n'X'\n"
                    "BEGIN_ARRAY 1 1\n'X'\n'0^0'\n'1^1'\n'-63'\n'18F'\n'1'\n'A'\n1\n'1^1'\n"
                    "END_ARRAY 1 1\nTOTAL_ARRAYS 1\n")},
       {}},
      {"W8019",
       {"scenario",
        folder.write("still.toml",
                     "begin = 0\nend = 1\nstep = 1\n[[source]]\nformula = \"clohessy_wiltshire\"\n"
                     "position = [0, -200, 0]\nrate = 1e-3\n[view]\nstars = 6\n")},
       {}},
      {"E8017",
       {"dataset", "plan", folder.write("plan.toml", "frmes = 1\n"), "-o", folder / "set"},
       {}},
      {"E8018", {"dataset", "check", folder / "none"}, {}},
      {"E9001", {"labels", folder.path(), "--format", "coco", "-o", folder / "coco"}, {}},
      {"W9002", {"labels", kLabels, "--format", "bop", "-o", folder / "bop"}, {}},
      {"E9003", {"labels", kLabels, "--format", "speed", "-o", folder / "speed"}, {}},
      {"E9005",
       {"run",
        folder.write("labels.toml",
                     "[[source]]\nfile = \"course.csv\"\n[labels]\nparts = { a = \"none\" }\n"),
        "--target", "f=" + pan, "-o", folder / "labelled", "--engine", "reference"},
       {}},
      {"E9601", {"dem", folder.write("cut.lbl", "PDS_VERSION_ID = PDS3\n")}, {}},
      {"E9602", {"dem", folder.write("unit.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")}, {}},
      {"W9603",
       {"dem", folder.write("zero.tab", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n"), "--unit", "m"},
       {}},
      {"N9604", {"dem", folder.write("bare.tab", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")}, {}},
      {"E9606", {"dem", folder.write("cut.tab", "v 0 0 0\nv 1 0\n"), "--unit", "m"}, {}},
      {"E9610", {"dem", pan}, {}},
      {"E9611", {"check", damaged_terrain(folder)}, {}},
      {"E9613", {"compile", terrain_text(folder, "beyond.pxn", "pixels=\"100 0 200 50\"")}, {}},
      {"W9614",
       {"compile", terrain_text(folder, "alone.pxn", "blend=\"50m\""), "-o", folder / "alone.pan"},
       {}},
      {"W9615", {"dem", damaged_terrain(folder), "--at", "-87.6177 56.84"}, {}},
      {"W0270", {"render", pan, "-o", png, "--size", "8x8", "--ifov", "20"}, {}},
      {"W5022",
       {"render", "ground=" + terrain_of(folder, "inside.pan"), pan, "-o", png, "--size", "8x8",
        "--engine", "reference", "--samples", "1"},
       {}},
      {"N5023",
       {"render", terrain_of(folder, "night.pan"), "-o", png, "--size", "8x8", "--engine",
        "reference", "--samples", "1", "--sun", "0.2 -1 0.1"},
       {}},
      {"W9670", {"dem", terrain_of(folder, "sound.pan"), "--at", "89 0"}, {}},
      {"W9671", {"dem", bare_header(folder), "-o", folder / "bare.pan"}, {}},
      {"W9620", {"export", terrain_of(folder, "sound.pan"), "-o", folder / "sound.glb"}, {}},
      {"E9612", {"dem", kCrater, "--values", "plain", "-o", folder / "plain.pan"}, {}},
      {"E0101", {"check", folder / "none.pxn"}, {}},
      {"E0102", {"check", folder / "unreadable.pxn"}, {}},
      {"E0103", {"compile", kFigure8, "-o", folder / "no/f.pan"}, {}},
      {"E0104", {"check", kFigure8, "--max-input", "100"}, {}},
      {"E0201", {"render", pan, "-o", png, "--fov", "200"}, {}},
      {"E0202", {"check", folder.write("model.txt", "")}, {}},
      {"E0203", {"render", pan, "--views", view}, {}},
      {"E0204", {"explain", "E9999"}, {}},
      {"E0207",
       {"render", "--again", folder.write("bare.png", "\x89PNG\r\n\x1a\n"), "-o", png},
       {}},
      {"W0208", {"render", "--again", folder / "changed.png", "-o", folder / "same.png"}, {}},
      {"E0206", {"compile", kFigure8, "-o", folder / "same.pan", "-M", folder / "same.pan"}, {}},
      {"E1225", {"compile", kFigure8, "-o", pan, "-D", "span=1m"}, {}},
      {"E1317", {"upgrade", braces}, {}},
      {"E1409", {"material", "--fit", folder.write("short.csv", "1 2 3\n")}, {}},
      {"W1408", {"compile", chalk, "-o", folder / "chalk.pan"}, {}},
      {"W2020", {"compile", inwards, "-o", folder / "inwards.pan"}, {}},
      {"E6002", {"import", folder.write("deep.wrl", nested)}, {}},
      {"E6220",
       {"import",
        folder.write("two.urdf", "<robot name=\"r\"><link name=\"a\"/><link name=\"a\"/></robot>")},
       {}},
      {"W6221",
       {"import", folder.write("free.urdf",
                               "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint "
                               "name=\"j\" type=\"revolute\">"
                               "<parent link=\"a\"/><child link=\"b\"/></joint></robot>")},
       {}},
      {"W6013",
       {"import", folder.write("box.wrl", "#VRML V2.0 utf8\nShape { geometry Box {} }"), "--units",
        "mm"},
       {}},
      {"E6217", {"import", (kBadCad / "N6216.gltf").string(), "--animation", "fold"}, {}},
      {"E6003", {"import", folder.write("cut.wrl", std::string("\x1f\x8b\x08\0\0\0", 6))}, {}},
      {"N2021",
       {"compile", PANWRIGHT_SOURCE_DIR "/examples/cad/relay.pxn", "-o", folder / "dressed.pan"},
       {}},
      {"N2029",
       {"check", folder.write("rod.pxn",
                              "<pangu_model ver=\"1\"><budget tolerance=\"1mm\"/><cylinder "
                              "radius=\"2mm\" height=\"1\"/>"
                              "</pangu_model>")},
       {}},
      {"N2025",
       {"compile",
        folder.write("fitted.pxn",
                     "<pangu_model ver=\"1\"><budget nearest=\"5km\" ifov=\"0.1mrad\" flux=\"1%\"/>"
                     "<sphere radius=\"5\"/><sphere radius=\"1cm\" translate=\"0 0 6\"/>"
                     "</pangu_model>"),
        "-o", folder / "fitted.pan"},
       {}},
      {"N2024",
       {"compile",
        folder.write("foil.pxn",
                     "<pangu_model ver=\"1\"><budget nearest=\"10m\" ifov=\"1mrad\"/><mli "
                     "type=\"flat\"><mli_settings><width>1</width><height>1</height><xgrid>400"
                     "</xgrid></mli_settings><mli_operations><random>1mm</random>"
                     "</mli_operations></mli></pangu_model>"),
        "-o", folder / "foil.pan"},
       {}},
      {"N6304",
       {"import", PANWRIGHT_SOURCE_DIR "/examples/cad/relay.wrl", "-o", folder / "relay.pan"},
       {}},
      {"W6402", {"export", kFigure8, "-o", folder / "f.glb"}, {}},
      {"N1318", {"upgrade", whole, part}, {}},
      {"E5005", {"render", pan, "-o", png, "--camera-frame", "camera"}, {}},
      {"E5013", {"joints", jointed, "--joint", "wing=1"}, {}},
      {"E5014", {"joints", jointed, "--joint", "drive=100deg"}, {}},
      {"W5015", {"joints", jointed, "--joint", "drive=@-1 0 1"}, {}},
      {"E5009", {"render", "a=" + pan, "a=" + kFigure8, "-o", png}, {}},
      {"E5010", crowd(pan), {}},
      {"E5011", {"render", pan, "-o", png, "--pose", "b=0 0 0 1 0 0 0"}, {}},
      {"N5004", {"render", pan, "-o", png, "--camera", "0 0 9"}, {}},
      {"W5008",
       {"render", pan, "-o", png, "--engine", "reference", "--until-error", "0.0001%",
        "--max-samples", "100", "--size", "8x8"},
       {}},
  };
#ifdef PANWRIGHT_STEP
  const std::string step = PANWRIGHT_SOURCE_DIR "/tests/importers/step/data/";
  triggers.push_back({"E6601", {"import", step + "E6601.step"}, {}});
  triggers.push_back({"W6602", {"import", step + "W6602.step"}, {}});
#endif
#ifdef PANWRIGHT_GL
  triggers.insert(
      triggers.end(),
      {{"W5012",
        {"render", pan, "-o", png, "--shadow-side", "16", "--size", "512x512", "--samples", "1"},
        {}},
       {"E5001", {"render", pan, "-o", png, "--gl", "osmesa"}, {"MESA_GL_VERSION_OVERRIDE=3.0"}},
       {"E5003",
        {"render", pan, "-o", png, "--gl", "osmesa", "--size", "16384x16384", "--samples", "64",
         "--max-image-memory", "1MB"},
        {}},
       {"W5006",
        {"render", pan, "-o", png, "--gl", "osmesa", "--camera", "0 -9 0", "--look-at", "0 -99 0",
         "--size", "8x8"},
        {}},
       {"W5020",
        {"render",
         folder.write("lit.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>"), "-o",
         png, "--gl", "osmesa", "--size", "8x8", "--shadows", "soft", "--lamp",
         "point intensity 1 radius 1cm", "--lamp", "point at 0 0 0.1 intensity 1 radius 1cm"},
        {}},
       {"W5021",
        {"render", "ground=" + terrain_of(folder, "near.pan"),
         "lit=" + folder.write("wing.pxn",
                               "<pangu_model ver=\"1\"><box size=\"40 1 1\"/></pangu_model>"),
         "-o", png, "--gl", "osmesa", "--size", "8x8", "--sun", "0.5 0.8 -1", "--pose",
         "lit=39515.6 60467 -1736330 1 0 0 0"},
        {}},
       {"W5016",
        {"render",
         folder.write("box.pxn", "<pangu_model ver=\"1\"><box size=\"1\"/></pangu_model>"), "-o",
         png, "--gl", "osmesa", "--camera", "0 0 0.1", "--size", "8x8"},
        {}},
       {"N5002",
        {"render", pan, "-o", png, "--gl", "auto", "--size", "8x8"},
        {"__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent.json"}}});
#else
  triggers.push_back({"E5007", {"render", pan, "-o", png}, {}});
#endif
  return triggers;
}

TEST(Coverage, EveryCodeIsProducedByAnInput) {
  std::map<std::string, std::string> produced;  // code → by what
  for (const auto& entry : fs::recursive_directory_iterator(kBad)) {
    const std::string code = code_in(entry.path());
    if (!entry.is_regular_file() || !code_from_name(code)) continue;
    const bool model = entry.path().extension() == ".pxn";
    if (!model) continue;
    // what only the compiler finds needs a compilation
    const auto codes = codes_of({"info", entry.path().string()});
    EXPECT_TRUE(codes.contains(code)) << entry.path() << " does not produce the code of its name";
    for (const std::string& each : codes) produced.emplace(each, entry.path().filename().string());
  }
  for (const auto& entry : fs::directory_iterator(kBadCad)) {
    const std::string code = code_in(entry.path());
    ASSERT_TRUE(code_from_name(code)) << entry.path();
    const auto codes = codes_of({"import", entry.path().string()});
    EXPECT_TRUE(codes.contains(code)) << entry.path() << " does not produce the code of its name";
    for (const std::string& each : codes) produced.emplace(each, entry.path().filename().string());
  }
  const TemporaryFolder folder;
  for (const auto& [code, bytes] : support::damaged_examples()) {
    const std::string name(code_info(code).name);
    const std::string path = folder.write(
        "damaged.pan", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    EXPECT_TRUE(codes_of({"check", path}).contains(name)) << name;
    produced.emplace(name, "a damaged pan");
  }
  for (const Trigger& trigger : command_lines(folder)) {
    EXPECT_TRUE(codes_of(trigger.words, trigger.environment).contains(trigger.code))
        << trigger.code;
    produced.emplace(trigger.code, "a command line");
  }
  // a busy machine starts programs late
  for (unsigned wait = 700'000; wait < 20'000'000 && !produced.contains("E0001"); wait *= 2) {
    const support::Outcome stopped =
        support::run_and_signal({PANWRIGHT_BIN_DIR "/panwright", "render", kFigure8, "--engine",
                                 "reference", "--size", "64x64", "--until-error", "1e-9",
                                 "--max-samples", "1073741824", "-o", folder / "long.png"},
                                SIGINT, wait);
    EXPECT_EQ(stopped.code, 128 + SIGINT);
    EXPECT_FALSE(fs::exists(folder / "long.png"));
    if (stopped.err.find("[E0001]") != std::string::npos) produced.emplace("E0001", "a signal");
  }
  // sanitizers take more address space than any limit
  const std::string large = folder.write("large.pxn",
                                         "<pangu_model ver=\"1\"><ellipsoid radii=\"1\" "
                                         "segments=\"100000\" rings=\"100\"/></pangu_model>");
  const support::Outcome limited = support::run(
      {"/bin/sh", "-c", "ulimit -v 600000; exec " PANWRIGHT_BIN_DIR "/panwright check " + large});
  if (limited.err.find("[E0002]") != std::string::npos) produced.emplace("E0002", "a limit");
  const support::Outcome converter =
      support::run({PANWRIGHT_BIN_DIR "/pxn2pan", "-lic", "x", kFigure8, "-o", folder / "x.pan"});
  if (converter.err.find("[N0205]") != std::string::npos) produced.emplace("N0205", "pxn2pan");

  for (const CodeInfo& info : all_codes()) {
    // the program takes one target at least; other hosts need not: tests/workspace/run_test.cpp
    if (info.name == "E5030") continue;
    if (info.name == "E0003") continue;  // a defect of the program
#ifdef PANWRIGHT_SANITIZED
    if (info.name == "E0002") continue;
#endif
#ifndef PANWRIGHT_STEP
    // builds with OpenCASCADE report them
    if (info.name == "E6601" || info.name == "W6602") continue;
#endif
#ifdef PANWRIGHT_GL
    if (info.name == "E5007") continue;  // a build without OpenGL reports it: preset nogl
#else
    if (info.name.substr(1) == "5001" || info.name.substr(1) == "5002" ||
        info.name.substr(1) == "5003" || info.name.substr(1) == "5006" || info.name == "W5012" ||
        info.name == "W5016" || info.name == "W5020" || info.name == "W5021")
      continue;  // builds with OpenGL report them
#endif
    EXPECT_TRUE(produced.contains(std::string(info.name)))
        << info.name << " is produced by no input";
  }
}

// The explanations name no option or file that does not exist.
TEST(Coverage, ExplanationsNameRealOptions) {
  std::string help;
  for (const char* command : {"compile", "check", "info", "render", "run", "import", "dem"})
    help += support::run({PANWRIGHT_BIN_DIR "/panwright", command, "--help"}).out;
  for (const CodeInfo& info : all_codes()) {
    const std::string_view text = info.explanation;
    for (std::size_t at = text.find(" --"); at != std::string_view::npos;
         at = text.find(" --", at + 1)) {
      std::size_t end = at + 3;
      while (end < text.size() &&
             (std::isalpha(static_cast<unsigned char>(text[end])) || text[end] == '-'))
        ++end;
      const std::string option(text.substr(at + 1, end - at - 1));
      EXPECT_NE(help.find(option), std::string::npos) << info.name << " names " << option;
    }
  }
}

}  // namespace
}  // namespace panwright::coverage_test
