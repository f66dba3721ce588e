// Builder of lists of damaged pan files.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/pan_damage.h"
#include "tests/support/pan_sample.h"

namespace panwright::support {

// List of damaged files that grows by one call each.
class Collection {
 public:
  // Bytes as they are.
  void raw(Code code, std::string what, std::vector<std::byte> bytes) {
    list_.push_back({code, std::move(what), std::move(bytes)});
  }
  // Changes the small file and computes its checksums anew, those that still can be.
  enum class Seal { all, directory, header, none };
  void changed(Code code, std::string what, const std::function<void(OpenPan&)>& change,
               Seal seal = Seal::all) {
    OpenPan file(small_pan());
    change(file);
    if (seal == Seal::all) file.seal();
    if (seal == Seal::directory) file.seal_directory();
    if (seal == Seal::header) file.seal_header();
    raw(code, std::move(what), file.bytes());
  }
  std::vector<DamagedPan> take() { return std::move(list_); }

 private:
  std::vector<DamagedPan> list_;
};

// Records of other sizes than this program's, and compressed sections: pan_damage_storage.cpp.
void record_sizes(Collection& add);
void compression(Collection& add);

}  // namespace panwright::support
