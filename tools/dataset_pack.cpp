#include "tools/dataset_pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/file.h"

namespace panwright::tools {

namespace {

namespace fs = std::filesystem;
constexpr std::uint64_t kBlock = 512;

// Header of a member: IEEE Std 1003.1, ustar. Owner and time are left at 0.
std::array<char, kBlock> tar_header(const std::string& name, std::uint64_t size) {
  std::array<char, kBlock> out{};
  const auto put = [&](std::size_t at, const std::string& text) {
    std::memcpy(out.data() + at, text.data(), text.size());
  };
  put(0, name);
  put(100, "0000644");
  put(108, "0000000");
  put(116, "0000000");
  put(124, fmt::format("{:011o}", size));
  put(136, "00000000000");
  put(148, "        ");
  out[156] = '0';
  put(257, "ustar");
  put(263, "00");
  unsigned sum = 0;
  for (const char c : out) sum += static_cast<unsigned char>(c);
  put(148, fmt::format("{:06o}", sum));
  out[154] = '\0';
  return out;
}

bool add_member(AtomicFile& tar, const fs::path& file, const std::string& name,
                DiagnosticLog& log) {
  constexpr std::uint64_t kMostMember = 8ull << 30;  // that the header holds
  const auto mapped = MappedFile::open(file, log);
  if (!mapped) return false;
  const std::uint64_t size = mapped->bytes().size();
  if (size >= kMostMember) {
    log.report_file(Code("E0103"), file.string(), "it is over 8 GiB, which no ustar archive holds");
    return false;
  }
  const auto header = tar_header(name, size);
  return tar.write(std::as_bytes(std::span(header)), log) && tar.write(mapped->bytes(), log) &&
         tar.extend((kBlock - size % kBlock) % kBlock, log);
}

}  // namespace

Result<std::vector<std::string>> pack_dataset(const DatasetFolder& set, const std::string& folder,
                                              std::uint64_t per_shard, DiagnosticLog& log,
                                              const Job& job) {
  std::vector<std::string> out;
  const std::uint64_t count = set.rows().size();
  const bool good = run_job(job, log, [&] {
    Phase phase(job, "packing", count);
    for (std::uint64_t first = 0; first < count; first += per_shard) {
      const fs::path path = fs::path(folder) / fmt::format("shard-{:06}.tar", first / per_shard);
      auto tar = AtomicFile::create(path, log);
      if (!tar) return false;
      for (std::uint64_t k = first; k < std::min(first + per_shard, count); ++k) {
        job.poll();
        std::vector<std::string> files = set.files_of(k);
        files.push_back(set.name(k) + std::string(kFrameExtension));
        for (const std::string& file : files)
          if (!add_member(*tar, set.frames_path() / file, file, log)) return false;
        phase.advance();
      }
      if (!tar->extend(2 * kBlock, log) || !tar->commit(log)) return false;
      out.push_back(path.string());
    }
    for (const char* name : {"README.md", "set.json", "coverage.svg"}) {
      const auto file = MappedFile::open(set.path() / name, log);
      if (!file || !write_file(fs::path(folder) / name, file->bytes(), log)) return false;
    }
    return true;
  });
  if (!good) return failed;
  return out;
}

}  // namespace panwright::tools
