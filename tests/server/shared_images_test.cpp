#include "server/shared_images.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

namespace panwright::server {
namespace {

bool is_there(const std::string& name) {
  struct stat info {};
  return ::stat(("/dev/shm" + name).c_str(), &info) == 0;
}

std::uint64_t shared_word(const unsigned char* at) {
  return __atomic_load_n(reinterpret_cast<const std::uint64_t*>(at), __ATOMIC_ACQUIRE);
}

// Reader written from docs/json-lines.md alone.
class Reader {
 public:
  explicit Reader(const std::string& name) {
    const int file = ::shm_open(name.c_str(), O_RDONLY, 0);
    struct stat info {};
    ::fstat(file, &info);
    bytes_ = static_cast<std::size_t>(info.st_size);
    memory_ =
        static_cast<const unsigned char*>(::mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, file, 0));
    ::close(file);
    std::memcpy(&slots_, memory_ + 8, 4);
    std::memcpy(&slot_bytes_, memory_ + 16, 8);
    std::memcpy(&first_, memory_ + 24, 8);
  }
  ~Reader() { ::munmap(const_cast<unsigned char*>(memory_), bytes_); }

  bool has_magic() const { return std::memcmp(memory_, "PWIMAGE1", 8) == 0; }
  std::uint64_t newest() const { return shared_word(memory_ + 32); }
  const unsigned char* slot(std::uint64_t number) const {
    return memory_ + first_ + number % slots_ * slot_bytes_;
  }
  std::uint64_t sequence(std::uint64_t number) const { return shared_word(slot(number)); }

  // The first layer as words, copied without any care.
  std::vector<std::uint32_t> copy(std::uint64_t number) const {
    const unsigned char* const at = slot(number);
    std::uint64_t offset = 0, bytes = 0;
    std::memcpy(&offset, at + 24 + 32, 8);
    std::memcpy(&bytes, at + 24 + 40, 8);
    std::vector<std::uint32_t> out(bytes / 4);
    std::memcpy(out.data(), at + offset, bytes);
    __atomic_thread_fence(__ATOMIC_ACQUIRE);
    return out;
  }

 private:
  const unsigned char* memory_ = nullptr;
  std::size_t bytes_ = 0;
  std::uint32_t slots_ = 0;
  std::uint64_t slot_bytes_ = 0, first_ = 0;
};

// An image whose every word is its number.
SharedImages::Place write_number(SharedImages& images, std::vector<std::uint32_t>& words,
                                 std::uint32_t number) {
  std::ranges::fill(words, number);
  const SharedLayer layer{"node_id", shared::NumberType::uint32, 1,
                          std::as_bytes(std::span(words))};
  DiagnosticLog log;
  auto place = images.write(static_cast<std::uint32_t>(words.size()), 1, {&layer, 1}, log);
  EXPECT_TRUE(place) << to_json(log);
  return place ? *place : SharedImages::Place{};
}

TEST(SharedImages, LayersLieWhereTheAnswerAndTheTableSay) {
  SharedImages images;
  const std::vector<float> radiance = {1, 2, 3, 4, 5, 6};
  const std::vector<std::uint16_t> numbers = {7, 8};
  const SharedLayer layers[] = {
      {"radiance", shared::NumberType::float32, 3, std::as_bytes(std::span(radiance))},
      {"dn", shared::NumberType::uint16, 1, std::as_bytes(std::span(numbers))}};
  DiagnosticLog log;
  const auto place = images.write(2, 1, layers, log);
  ASSERT_TRUE(place);
  EXPECT_EQ(place->number, 1u);
  const Reader reader(place->name);
  EXPECT_TRUE(reader.has_magic());
  EXPECT_EQ(reader.newest(), 1u);
  EXPECT_EQ(reader.sequence(1), 2u);
  const unsigned char* const at = reader.slot(1);
  const std::uint32_t size[] = {2, 1, 2};
  EXPECT_EQ(std::memcmp(at + 8, size, sizeof size), 0);
  for (std::size_t k = 0; k < 2; ++k) {
    const unsigned char* const layer = at + 24 + 48 * k;
    EXPECT_EQ(reinterpret_cast<const char*>(layer), layers[k].name);
    std::uint32_t type = 9, channels = 9;
    std::uint64_t offset = 0, bytes = 0;
    std::memcpy(&type, layer + 24, 4);
    std::memcpy(&channels, layer + 28, 4);
    std::memcpy(&offset, layer + 32, 8);
    std::memcpy(&bytes, layer + 40, 8);
    EXPECT_EQ(type, k == 0 ? 0u : 2u);
    EXPECT_EQ(channels, k == 0 ? 3u : 1u);
    ASSERT_EQ(bytes, layers[k].bytes.size());
    EXPECT_EQ(offset % 64, 0u);
    EXPECT_EQ(std::memcmp(at + offset, layers[k].bytes.data(), bytes), 0);
  }
}

// note: shows that a copy without the check is torn, else this machine tests nothing
TEST(SharedImages, NoImageWithItsSequenceIsTorn) {
  SharedImages images;
  std::vector<std::uint32_t> words(1 << 16);
  const std::string name = write_number(images, words, 1).name;
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {  // a reader of its own process, at full speed
    const Reader reader(name);
    std::uint64_t whole = 0, wrong = 0, torn = 0;
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while ((whole < 200 || torn == 0) && std::chrono::steady_clock::now() < end) {
      const std::uint64_t number = reader.newest();
      const bool before = reader.sequence(number) == 2 * number;
      const std::vector<std::uint32_t> copy = reader.copy(number);
      const bool after = reader.sequence(number) == 2 * number;
      const bool is_one = std::ranges::all_of(
          copy, [&](std::uint32_t word) { return word == static_cast<std::uint32_t>(number); });
      if (before && after)
        ++(is_one ? whole : wrong);
      else
        torn += is_one ? 0 : 1;
    }
    const std::uint64_t counts[] = {whole, wrong, torn};
    (void)!::write(pipe_ends[1], counts, sizeof counts);
    ::_exit(0);
  }
  std::uint32_t number = 1;
  while (::waitpid(child, nullptr, WNOHANG) == 0)
    for (int k = 0; k < 100; ++k) write_number(images, words, ++number);
  std::uint64_t counts[3] = {};
  ASSERT_EQ(::read(pipe_ends[0], counts, sizeof counts), static_cast<ssize_t>(sizeof counts));
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
  EXPECT_GT(counts[0], 100u);
  EXPECT_EQ(counts[1], 0u);
  EXPECT_GT(counts[2], 0u);
}

TEST(SharedImages, LargerImagesHaveASegmentOfAnotherName) {
  SharedImages images;
  std::vector<std::uint32_t> small(16, 5), large(1 << 12, 6);
  const auto first = write_number(images, small, 5);
  const auto second = write_number(images, small, 6);
  EXPECT_EQ(first.name, second.name);
  EXPECT_NE(first.slot, second.slot);
  const Reader old(first.name);
  const auto third = write_number(images, large, 7);
  EXPECT_NE(third.name, first.name);
  EXPECT_EQ(third.number, 1u);
  EXPECT_FALSE(is_there(first.name));
  EXPECT_TRUE(is_there(third.name));
  EXPECT_EQ(old.copy(2)[15], 6u) << "a reader keeps what it has";
  EXPECT_EQ(write_number(images, small, 8).name, third.name);
}

TEST(SharedImages, NamesGoWithTheirServersAndThoseOfKilledOnesLater) {
  std::vector<std::uint32_t> words(16);
  std::string name;
  {
    SharedImages images;
    name = write_number(images, words, 1).name;
    EXPECT_TRUE(is_there(name));
    SharedImages::remove_left_over();
    EXPECT_TRUE(is_there(name)) << "its server lives";
  }
  EXPECT_FALSE(is_there(name));
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    SharedImages images;
    char text[64] = {};
    write_number(images, words, 1).name.copy(text, sizeof text - 1);
    (void)!::write(pipe_ends[1], text, sizeof text);
    for (;;) ::pause();
  }
  char text[64] = {};
  ASSERT_EQ(::read(pipe_ends[0], text, sizeof text), static_cast<ssize_t>(sizeof text));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_TRUE(is_there(text));
  EXPECT_GE(SharedImages::remove_left_over(), 1u);
  EXPECT_FALSE(is_there(text));
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
}

}  // namespace
}  // namespace panwright::server
