// Models of terrain, made of heights by the library's own readers and writer.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "terrain/tile_writer.h"
#include "tests/support/process.h"
#include "world/world.h"

namespace panwright::support {

// Model of the heights of a PDS3 (".lbl") or ENVI (".hdr") label, metres over the sphere.
inline world::ModelPtr terrain_model(const std::string& label, const std::vector<float>& heights,
                                     const char* extension) {
  const TemporaryFolder folder;
  std::string data(4 * heights.size(), 0);
  std::memcpy(data.data(), heights.data(), data.size());
  (void)folder.write(std::string("a") + (extension[1] == 'h' ? ".dat" : ".img"), data);
  const std::string path = folder.write(std::string("a") + extension, label);
  DiagnosticLog log;
  terrain::DemOptions reading;
  reading.unit = 1;
  reading.quantity = terrain::Quantity::height;
  const auto dem = terrain::Dem::open(path, reading, log);
  EXPECT_TRUE(dem) << to_text(log);
  EXPECT_TRUE(terrain::write_tiles({&*dem, 1}, folder / "a.pan", {}, log)) << to_text(log);
  auto model = pan::Model::open(folder / "a.pan", log);
  EXPECT_TRUE(model && model->check(log)) << to_text(log);
  return std::make_shared<const pan::Model>(*std::move(model));
}

// A plane of side × side posts, 1 m apart, about the origin: x = column - (side - 1) / 2,
// y = (side - 1) / 2 - row.
inline world::ModelPtr plane_model(int side, const std::vector<float>& heights) {
  const std::string size = std::to_string(side), half = std::to_string(0.5 * side);
  return terrain_model(
      "ENVI\nsamples = " + size + "\nlines = " + size +
          "\nbands = 1\ndata type = 4\nbyte order = 0\nmap info = {Local, 1, 1, -" + half + ", " +
          half + ", 1, 1}\n",
      heights, ".hdr");
}

// A globe of radius 1737.4 km, 2 pixels a degree: 720 x 360 heights.
inline world::ModelPtr globe_model(const std::vector<float>& heights) {
  return terrain_model(
      "PDS_VERSION_ID = PDS3\n^IMAGE = \"a.img\"\nOBJECT = IMAGE\n LINES = 360\n LINE_SAMPLES = "
      "720\n SAMPLE_TYPE = PC_REAL\n SAMPLE_BITS = 32\n UNIT = METER\nEND_OBJECT\nOBJECT = "
      "IMAGE_MAP_PROJECTION\n A_AXIS_RADIUS = 1737.4 <km>\n POSITIVE_LONGITUDE_DIRECTION = EAST\n "
      "CENTER_LONGITUDE = 0\n MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\n CENTER_LATITUDE = "
      "0\n MAP_RESOLUTION = 2 <pix/deg>\n LINE_PROJECTION_OFFSET = 179.5\n "
      "SAMPLE_PROJECTION_OFFSET = 359.5\nEND_OBJECT\nEND\n",
      heights, ".lbl");
}

}  // namespace panwright::support
