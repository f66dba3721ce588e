#include "tools/run_album.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <system_error>

#include "base/file.h"
#include "base/program.h"
#include "base/text.h"
#include "image/video.h"

namespace panwright::tools {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostOfSheet = 36;
constexpr std::uint32_t kSideOfSheet = 320;  // pixels of an image
constexpr std::uint16_t kRate = 25;          // images a second

std::string extension_of(const std::string& file) { return fs::path(file).extension().string(); }

// A frame for ffmpeg: the file itself, or one for people beside it where it holds numbers.
bool place_frame(const fs::path& frame, const fs::path& name, std::error_code& error,
                 DiagnosticLog& log) {
  const auto file = MappedFile::open(frame, log);
  if (!file) return false;
  const auto shown = image::shown_png(file->bytes(), frame, log);
  if (!shown) return false;
  if (!shown->empty()) return write_file(name, as_bytes(*shown), log);
  fs::create_symlink(fs::absolute(frame), name, error);
  return !error;
}

bool encode(const std::string& output, std::span<const fs::path> frames, const fs::path& folder,
            DiagnosticLog& log, const Job& job) {
  const fs::path names = fs::absolute(folder) / ".video";
  const fs::path made = names / ("video" + extension_of(output));
  std::error_code error;
  fs::remove_all(names, error);
  fs::create_directories(names, error);
  bool good = !error;
  for (std::size_t k = 0; k < frames.size() && good && !job.cancelled(); ++k)
    good = place_frame(frames[k], names / fmt::format("{:08}.png", k), error, log);
  const bool placed = good;
  good = good && image::encode_video(find_program("ffmpeg"), names / "%08d.png", kRate, made, job);
  if (good) {
    fs::copy_file(made, output, fs::copy_options::overwrite_existing, error);
    good = !error;
  }
  std::error_code ignored;
  fs::remove_all(names, ignored);
  if (job.cancelled())
    report_cancelled(log);
  else if (!good && (placed || error))
    log.report_file(Code("E0103"), output,
                    error ? "the video cannot be written: " + error.message()
                          : "ffmpeg could not join the frames",
                    "the frames are kept; --video FILE.png needs no ffmpeg");
  return good;
}

}  // namespace

void declare(Arguments& arguments, AlbumOptions& options) {
  arguments
      .add("--sheet", options.sheet,
           "Contact sheet of the frames to write: at most 36 of them, evenly chosen")
      .type("FILE.png");
  arguments
      .add("--video", options.video,
           "Video of the frames to write, 25 a second: .png (animated), or by ffmpeg .mp4, .mkv, "
           ".mov, .webm, .avi or .gif")
      .type("FILE");
}

bool check(const AlbumOptions& options, DiagnosticLog& log) {
  if (!options.sheet.empty()) {
    if (extension_of(options.sheet) != ".png") {
      log.report(Code("E0202"), {},
                 fmt::format("--sheet is {}, expected a .png file", in_quotes(options.sheet)));
      return false;
    }
  }
  if (options.video.empty()) return true;
  const std::string extension = extension_of(options.video);
  const bool encodes =
      std::ranges::find(image::kVideoExtensions, extension) != std::end(image::kVideoExtensions);
  if (!encodes && extension != ".png") {
    log.report(Code("E0202"), {},
               fmt::format("--video is {}, expected .png or {}", in_quotes(options.video),
                           fmt::join(image::kVideoExtensions, ", ")));
    return false;
  }
  if (encodes && find_program("ffmpeg").empty()) {
    log.report(Code("E0201"), {},
               fmt::format("--video is {}, which ffmpeg makes; it is not installed",
                           in_quotes(options.video)),
               "--video FILE.png is an animated PNG and needs no other program");
    return false;
  }
  return true;
}

bool claim_files(const AlbumOptions& options, DiagnosticLog& log) {
  return (options.sheet.empty() || log.files()->will_write(options.sheet, "--sheet", log)) &&
         (options.video.empty() || log.files()->will_write(options.video, "--video", log));
}

bool make_album(const AlbumOptions& options, std::span<const fs::path> frames,
                const fs::path& folder, CommandContext& context) {
  DiagnosticLog& log = context.log();
  const Job& job = context.job();
  if (!options.sheet.empty()) {
    if (!image::write_sheet(options.sheet, frames, kMostOfSheet, kSideOfSheet, log, job))
      return false;
    context.wrote(options.sheet, fmt::format("{} of {}", std::min(kMostOfSheet, frames.size()),
                                             counted(frames.size(), "frame")));
  }
  if (options.video.empty()) return true;
  const bool animated = extension_of(options.video) == ".png";
  if (animated ? !image::write_animation(options.video, frames, kRate, log, job)
               : !encode(options.video, frames, folder, log, job))
    return false;
  context.wrote(options.video, counted(frames.size(), "frame"));
  return true;
}

}  // namespace panwright::tools
