// Random numbers of pixels: functions of seed, frame, stage and pixel. No state, no libm, so that
// tiles, threads, machines and compilers give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace panwright::sensor {

// Random numbers of one stage of one frame. The Philox counter of a pixel is (block, pixel, frame,
// stage), blocks from 0.
struct Stream {
  std::array<std::uint32_t, 2> seed{};  // the key
  std::uint32_t frame = 0;
  std::uint32_t stage = 0;
};

// Draws exact Poisson numbers of given means for pixels first, first + 1, …: by inversion below a
// mean of 10, above by transformed rejection. Uniform numbers have 52 bits.
//
// Source: W. Hörmann, "The transformed rejection method for generating Poisson random variables",
// 1993, algorithm PTRS.
//
//   counts  whole numbers, of the size of `means`; may be the same memory
// Expects: means from 0 to 1e12. Cost: some 20 ns a pixel.
void draw_poisson(std::span<const double> means, std::uint32_t first, const Stream& stream,
                  std::span<double> counts);

// Draws standard normal numbers (Box and Muller): pixels 2k and 2k + 1 share a block.
void draw_normal(std::uint32_t first, const Stream& stream, std::span<double> numbers);

// Draws two independent standard normal numbers for each pixel. Expects: spans of one size.
void draw_normal_pairs(std::uint32_t first, const Stream& stream, std::span<double> a,
                       std::span<double> b);

// Draws the first block of each pixel: four words. Expects: spans of one size.
void draw_words(std::uint32_t first, const Stream& stream,
                const std::array<std::span<std::uint32_t>, 4>& words);

}  // namespace panwright::sensor
