#include "workspace/watch.h"

#include <sys/stat.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>

namespace panwright::workspace {

FileStamp stamp_of(const std::filesystem::path& path) {
  FileStamp stamp{path, 0, -1, 0};
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return stamp;
  stamp.time = std::int64_t{found.st_mtim.tv_sec} * 1'000'000'000 + found.st_mtim.tv_nsec;
  stamp.size = found.st_size;
  stamp.inode = found.st_ino;
  return stamp;
}

std::vector<FileStamp> stamps_of(const std::vector<FileStamp>& files) {
  std::vector<FileStamp> out;
  for (const FileStamp& each : files) out.push_back(stamp_of(each.path));
  return out;
}

bool have_changed(std::vector<FileStamp>& known, const Job& job) {
  std::vector<FileStamp> now = stamps_of(known);
  if (now == known) return false;
  wait_until_still(now, job);
  known = std::move(now);
  return true;
}

void wait_until_still(std::vector<FileStamp>& known, const Job& job) {
  while (!job.cancelled()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    std::vector<FileStamp> later = stamps_of(known);
    if (later == known) return;
    known = std::move(later);
  }
}

void add_inputs(const pan::Model& model, const std::filesystem::path& path,
                std::set<std::filesystem::path>& files) {
  for (const auto& input : model.inputs())
    files.insert(path.parent_path() / std::string(model.string(input.path)));
}

void add_sources(const DiagnosticLog& log, std::set<std::filesystem::path>& files) {
  for (FileId file = 0; file < log.sources().size(); ++file)
    if (!log.sources().file(file).name.empty()) files.insert(log.sources().file(file).name);
}

}  // namespace panwright::workspace
