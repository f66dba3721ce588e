// panwright-gdal: reads rasters for terrain/ with GDAL, in a process of its own. GDAL is loaded
// when it runs, by its C interface, so that nothing is linked with it. Request on standard input,
// answer on standard output (terrain/internal/gdal_wire.h).
#include <dlfcn.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "terrain/internal/gdal_wire.h"

namespace {

bool send_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

void* library(const std::string& given) {
  if (!given.empty()) return dlopen(given.c_str(), RTLD_NOW);
  for (int version = 40; version >= 30; --version)
    if (void* found = dlopen(("libgdal.so." + std::to_string(version)).c_str(), RTLD_NOW))
      return found;
  return dlopen("libgdal.so", RTLD_NOW);
}

// The part of GDAL's C interface that is used; unchanged since its version 1.
struct Gdal {
  void (*register_all)() = nullptr;
  void* (*open)(const char*, int) = nullptr;
  int (*width)(void*) = nullptr;
  int (*height)(void*) = nullptr;
  int (*bands)(void*) = nullptr;
  void* (*band)(void*, int) = nullptr;
  int (*transform)(void*, double*) = nullptr;
  const char* (*projection)(void*) = nullptr;
  void* (*driver)(void*) = nullptr;
  const char* (*driver_name)(void*) = nullptr;
  int (*type)(void*) = nullptr;
  const char* (*type_name)(int) = nullptr;
  double (*missing)(void*, int*) = nullptr;
  double (*scale)(void*, int*) = nullptr;
  double (*offset)(void*, int*) = nullptr;
  const char* (*unit)(void*) = nullptr;
  int (*rows)(void*, int, int, int, int, int, void*, int, int, int, int, int) = nullptr;
  const char* (*last_error)() = nullptr;

  bool load(void* from) {
    const auto get = [from](auto& function, const char* name) {
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(from, name));
      return function != nullptr;
    };
    return get(register_all, "GDALAllRegister") && get(open, "GDALOpen") &&
           get(width, "GDALGetRasterXSize") && get(height, "GDALGetRasterYSize") &&
           get(bands, "GDALGetRasterCount") && get(band, "GDALGetRasterBand") &&
           get(transform, "GDALGetGeoTransform") && get(projection, "GDALGetProjectionRef") &&
           get(driver, "GDALGetDatasetDriver") && get(driver_name, "GDALGetDriverShortName") &&
           get(type, "GDALGetRasterDataType") && get(type_name, "GDALGetDataTypeName") &&
           get(missing, "GDALGetRasterNoDataValue") && get(scale, "GDALGetRasterScale") &&
           get(offset, "GDALGetRasterOffset") && get(unit, "GDALGetRasterUnitType") &&
           get(rows, "GDALRasterIO") && get(last_error, "CPLGetLastErrorMsg");
  }
};

std::string one_line(const char* text) {
  std::string out = text == nullptr ? "" : text;
  for (char& c : out)
    if (c == '\n' || c == '\r') c = ' ';
  return out;
}

int fail(const std::string& why) {
  send_all("error " + why + "\n\n");
  return 1;
}

void say(const char* key, const std::string& value) {
  if (!value.empty()) send_all(std::string(key) + " " + value + "\n");
}
std::string digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

int answer() {
  std::string path, band_text, first_text, count_text, given;
  if (!std::getline(std::cin, path) || !std::getline(std::cin, band_text) ||
      !std::getline(std::cin, first_text) || !std::getline(std::cin, count_text))
    return 2;
  std::getline(std::cin, given);
  send_all(panwright::terrain::kGdalMark);
  Gdal gdal;
  void* found = library(given);
  if (found == nullptr || !gdal.load(found)) return fail("absent");
  if (path.empty()) return fail("nothing to read");
  gdal.register_all();
  constexpr int kReadOnly = 0, kDouble = 7;
  void* file = gdal.open(path.c_str(), kReadOnly);
  if (file == nullptr) return fail(one_line(gdal.last_error()));
  const int number = std::atoi(band_text.c_str()), bands = gdal.bands(file);
  if (number < 1 || number > bands) return fail("it has " + std::to_string(bands) + " bands");
  void* band = gdal.band(file, number);
  const int width = gdal.width(file), height = gdal.height(file);
  say("driver", one_line(gdal.driver_name(gdal.driver(file))));
  say("width", std::to_string(width));
  say("height", std::to_string(height));
  say("bands", std::to_string(bands));
  say("type", one_line(gdal.type_name(gdal.type(band))));
  double place[6] = {};
  if (gdal.transform(file, place) == 0) {
    std::string numbers;
    for (const double value : place) numbers += digits(value) + " ";
    say("transform", numbers);
  }
  say("wkt", one_line(gdal.projection(file)));
  int known = 0;
  if (const double value = gdal.missing(band, &known); known) say("missing", digits(value));
  say("scale", digits(gdal.scale(band, &known)));
  say("offset", digits(gdal.offset(band, &known)));
  say("unit", one_line(gdal.unit(band)));
  send_all("\n");
  const int first = std::atoi(first_text.c_str()), count = std::atoi(count_text.c_str());
  if (first < 0 || count < 0 || count > height - std::min(first, height)) return 2;
  std::vector<double> row(static_cast<std::size_t>(width));
  for (int y = first; y < first + count; ++y) {
    if (gdal.rows(band, 0, 0, y, width, 1, row.data(), width, 1, kDouble, 0, 0) != 0) return 3;
    if (!send_all({reinterpret_cast<const char*>(row.data()), row.size() * sizeof(double)}))
      return 3;
  }
  return 0;
}

}  // namespace

int main(int argc, char**) {
  if (argc > 1 || isatty(STDIN_FILENO)) {
    std::fputs("panwright-gdal: part of panwright, which starts it to read rasters with GDAL\n",
               stderr);
    return 2;
  }
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  _exit(answer());
}
