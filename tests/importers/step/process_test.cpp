// The process that reads STEP files: what it answers, and what becomes of one that goes wrong.
// Scripts stand in for it where it has to crash, hang or lie.

#include <fcntl.h>
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

#include "compiler/compile.h"
#include "importers/step/internal/wire.h"
#include "tests/importers/step/reading.h"
#include "tests/importers/step/sample.h"
#include "tests/support/paths.h"
#include "tests/support/process.h"
#include "tests/support/sanitizers.h"

namespace panwright::importers::step::process_test {
namespace {

using support::TemporaryFolder;
using testing::HasSubstr;

constexpr const char* kVariable = "PANWRIGHT_STEP_READER";

// A program that is started in place of panwright-step as long as this lives.
class Stand {
 public:
  // lines of a shell script; $0.out is a file for it to write to
  explicit Stand(const std::string& lines) : path_(folder_.write("reader", "#!/bin/sh\n" + lines)) {
    chmod(path_.c_str(), 0700);
    setenv(kVariable, path_.c_str(), 1);
  }
  ~Stand() { unsetenv(kVariable); }
  Stand(const Stand&) = delete;
  Stand& operator=(const Stand&) = delete;
  std::string out() const { return path_ + ".out"; }
  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
  std::string path_;
};

// Every shape that a STEP file can become, colours, names and a diagnostic.
std::string everything() {
  Sample sample;
  const TDF_Label top = sample.assembly("top");
  const auto add = [&](const TopoDS_Shape& shape, const std::string& name) {
    const TDF_Label part = sample.part(shape, name);
    sample.place(top, part, gp_Trsf(), name + " in its place");
    return part;
  };
  sample.color(add(BRepPrimAPI_MakeBox(100, 200, 300).Shape(), "box"), {1, 0.5, 0});
  sample.material(add(BRepPrimAPI_MakeSphere(254).Shape(), "ball"), "steel");
  add(BRepPrimAPI_MakeTorus(300, 20).Shape(), "ring");
  add(BRepPrimAPI_MakeCylinder(100, 300).Shape(), "rod");
  add(BRepPrimAPI_MakeCone(100, 50, 300).Shape(), "cone");
  add(BRepPrimAPI_MakeCylinder(100, 300, kPi).Shape(), "half");
  add(BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(1, 0, 0)).Edge(), "wire");
  return sample.text();
}

std::vector<std::byte> pan_of(const Reading& reading) {
  DiagnosticLog log;
  auto out = compiler::compiled(reading.scene(), {}, log);
  EXPECT_TRUE(out) << to_text(log);
  return out ? *std::move(out) : std::vector<std::byte>();
}

TEST(StepProcess, AnswersWhatIsReadHere) {
  const std::string text = everything();
  const auto there = read(text);
  const auto here = read_here(text);
  ASSERT_TRUE(there->out) << to_text(there->log);
  ASSERT_TRUE(here->out);
  EXPECT_EQ(to_text(there->log), to_text(here->log));
  EXPECT_EQ(there->count(Code("N6007")), 1u);
  EXPECT_EQ(there->scene().shapes.size(), 6u);
  there->out->scene.inputs.clear();  // the importers' own
  EXPECT_EQ(pan_of(*there), pan_of(*here));
  ASSERT_EQ(there->out->materials.size(), here->out->materials.size());
  for (std::size_t i = 0; i < here->out->materials.size(); ++i) {
    const CadMaterial& a = there->out->materials[i];
    const CadMaterial& b = here->out->materials[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.base_color, b.base_color);
    EXPECT_EQ(a.opacity, b.opacity);
    EXPECT_EQ(a.lost.size(), b.lost.size());
    EXPECT_EQ(there->scene().materials[i].diffuse, here->scene().materials[i].diffuse);
  }
}

TEST(StepProcess, ThreadsReadAtTheSameTime) {
  const std::string text = everything();
  std::vector<std::unique_ptr<Reading>> readings(3);
  {
    std::vector<std::jthread> threads;
    for (auto& reading : readings) threads.emplace_back([&] { reading = read(text); });
  }
  for (const auto& reading : readings) {
    ASSERT_TRUE(reading->out) << to_text(reading->log);
    EXPECT_EQ(pan_of(*reading), pan_of(*readings[0]));
  }
}

// One error, with a code and words; nothing of a scene.
void expect_refused(Code code, const std::string& words, const Options& options = {}) {
  const auto reading = read("ISO-10303-21;\n" + std::string(1 << 20, ' '), options);
  EXPECT_FALSE(reading->out) << words;
  EXPECT_EQ(reading->log.errors(), 1u) << to_text(reading->log);
  EXPECT_EQ(reading->count(code), 1u) << to_text(reading->log);
  EXPECT_THAT(to_text(reading->log), HasSubstr(words));
}

TEST(StepProcess, OneThatCrashesIsAnError) {
  for (const char* how : {"", "cat > /dev/null; ", "printf PWSTEPA1; "}) {
    const Stand stand(std::string(how) + "kill -SEGV $$\n");
    expect_refused(Code("E6601"), "crashed (signal 11");
  }
  const Stand stand("kill -KILL $$\n");
  expect_refused(Code("E6601"), "crashed (signal 9");
}

TEST(StepProcess, OneThatEndsWithoutAnAnswerIsAnError) {
  const Stand stand("exit 7\n");
  expect_refused(Code("E6601"), "without an answer (exit code 7)");
}

TEST(StepProcess, OneThatIsNotThereIsNamed) {
  {
    const Stand stand("");
    chmod((stand.folder() / "reader").c_str(), 0600);
    expect_refused(Code("E6001"), "cannot be started");
  }
  setenv(kVariable, "/nonexistent/panwright-step", 1);
  EXPECT_FALSE(reads_step());
  expect_refused(Code("E6001"), "PANWRIGHT_STEP_READER names '/nonexistent/panwright-step'");
  unsetenv(kVariable);
  EXPECT_TRUE(reads_step());
}

bool runs(int pid) { return kill(pid, 0) == 0; }

// The processes whose numbers a stand-in has written.
std::vector<int> written_by(const Stand& stand) {
  std::istringstream in(support::contents(stand.out()));
  std::vector<int> out;
  for (int pid = 0; in >> pid;) out.push_back(pid);
  return out;
}

// Those of its group are adopted and waited for by init, which takes a moment.
void expect_gone(const std::vector<int>& processes) {
  for (const int pid : processes) {
    for (int i = 0; i < 200 && runs(pid); ++i) usleep(10'000);
    const std::string state = support::contents(fmt::format("/proc/{}/stat", pid));
    EXPECT_TRUE(!runs(pid) || state.find(") Z ") != state.npos) << state;
  }
}

TEST(StepProcess, OneThatHangsIsEndedWithAllThatItStarted) {
  for (const char* hang : {"sleep 1000 & echo $$ $! > $0.out; wait",
                           "trap '' TERM INT HUP; echo $$ > $0.out; exec sleep 1000",
                           // closes the socket
                           "exec < /dev/null > /dev/null; echo $$ > $0.out; exec sleep 1000",
                           // drop by drop
                           "printf PWSTEPA1; echo $$ > $0.out; while :; do sleep 0.05; done"}) {
    SCOPED_TRACE(hang);
    const Stand stand(hang);
    Options options;
    options.limits.seconds = 0.1;
    const auto reading = read("ISO-10303-21;", options);
    EXPECT_FALSE(reading->out);
    EXPECT_EQ(reading->count(Code("E6002")) + reading->count(Code("E6601")), 1u)
        << to_text(reading->log);
    const auto processes = written_by(stand);
    ASSERT_FALSE(processes.empty());
    EXPECT_FALSE(runs(processes[0])) << "not waited for";
    expect_gone(processes);
  }
}

TEST(StepProcess, ProcessorTimeIsLimited) {
  const Stand stand("while :; do :; done\n");
  Options options;
  options.limits.seconds = 0.9;  // 1 s of it, 3.6 s on the clock
  expect_refused(Code("E6002"), "more time than the limit allows", options);
}

TEST(StepProcess, ItsLimitsAreSetBeforeItReads) {
  const Stand stand("cat > /dev/null; (ulimit -v; ulimit -t; ulimit -c) > $0.out\n");
  Options options;
  options.limits.memory = 1ull << 30;
  options.limits.seconds = 30;
  expect_refused(Code("E6601"), "without an answer", options);
  std::istringstream said(support::contents(stand.out()));
  std::string memory, seconds, core;
  said >> memory >> seconds >> core;
#ifndef PANWRIGHT_SANITIZED
  EXPECT_LE(std::stoull(memory), 2u << 20);  // of 1024 bytes
#endif
  EXPECT_EQ(seconds, "30");
  EXPECT_EQ(core, "0");
}

#ifndef PANWRIGHT_SANITIZED
// The real one, with less than it needs.
TEST(StepProcess, MemoryIsLimited) {
  const std::string text = text_of(BRepPrimAPI_MakeSphere(254, 0, 1.5).Shape(), "cap");
  Options options;
  options.deflection = 2e-8;
  const Stand stand("ulimit -v 500000; exec " PANWRIGHT_BIN_DIR "/panwright-step\n");
  const auto reading = read(text, options);
  EXPECT_FALSE(reading->out && !reading->scene().instances.empty());
  EXPECT_EQ(reading->count(Code("E6002")), 1u) << to_text(reading->log);
  EXPECT_THAT(to_text(reading->log), HasSubstr("more memory than the limit allows"));
}
#endif

// The descriptors that a host has open, close-on-exec or not, are not handed on.
TEST(StepProcess, NothingOfTheHostIsHandedOn) {
  constexpr int kNumber = 77;
  ASSERT_EQ(dup2(STDIN_FILENO, kNumber), kNumber);
  const Stand stand("ls /proc/$$/fd > $0.out\n");
  expect_refused(Code("E6601"), "without an answer");
  close(kNumber);
  std::istringstream said(support::contents(stand.out()));
  std::vector<int> numbers;
  for (int number = 0; said >> number;) numbers.push_back(number);
  EXPECT_THAT(numbers, testing::IsSupersetOf({0, 1, 2}));
  for (const int number : numbers) EXPECT_LT(number, 20);  // the shell's own
}

TEST(StepProcess, ACancelledJobEndsIt) {
  const Stand stand("echo $$ > $0.out; exec sleep 1000\n");
  const Job job(JobOptions{});
  DiagnosticLog log;
  std::jthread canceller([&] {
    while (!std::filesystem::exists(stand.out())) usleep(1000);
    job.cancel();
  });
  const MemoryFile file{"model.step", "ISO-10303-21;"};
  EXPECT_FALSE(import_memory({&file, 1}, {}, log, job));
  EXPECT_TRUE(log.contains(Code("E0001")));
  EXPECT_EQ(log.errors(), 1u) << to_text(log);
  canceller.join();
  expect_gone(written_by(stand));
}

TEST(StepProcess, GarbageIsAnError) {
  for (const char* answer :
       {"echo garbage", "echo PWSTEPA1garbage0123456789", "yes | head -c 3000000",
        "printf PWSTEPA1; yes 0123456789 | head -c 3000000",
        // a record of 2^62 bytes
        "printf 'PWSTEPA1\\002\\000\\000\\000\\000\\000\\000\\000\\000\\000\\000\\100'"}) {
    SCOPED_TRACE(answer);
    const Stand stand("cat > /dev/null; " + std::string(answer) + "\n");
    expect_refused(Code("E6601"), "answer of the reader of STEP files is damaged");
  }
  // an answer that ends too early
  const Stand stand("cat > /dev/null; printf PWSTEPA1; printf 'PWSTEPA1' > $0.out\n");
  expect_refused(Code("E6601"), "without an answer (exit code 0)");
}

// ---- the form of answers

std::string answer_to(const std::string& text) {
  const auto reading = read_here(text);
  std::string out(kAnswerMark);
  const auto send = [&](std::string_view bytes) {
    out.append(bytes);
    return true;
  };
  send_diagnostics(reading->log, 0, send);
  if (reading->out) send_scene(*reading->out, send);
  send_end(reading->out.has_value(), send);
  return out;
}

// Bits of a counter (Steele and others' splitmix64).
std::uint64_t mixed(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15u;
  n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9u;
  n = (n ^ n >> 27) * 0x94d049bb133111ebu;
  return n ^ n >> 31;
}

struct Taken {
  AnswerReader::State state;
  std::optional<Imported> out;
};

Taken take(const std::string& answer, std::size_t piece, Limits limits = {}) {
  DiagnosticLog log;
  SourceFile source;
  source.name = "model.step";
  source.bytes = std::make_shared<const std::string>(100'000, ' ');
  Request request;
  request.path = request.name = source.name;
  request.limits = limits;
  request.bytes = 100'000;
  AnswerReader reader(request, log.sources().add(source), log);
  for (std::size_t at = 0; at < answer.size(); at += piece)
    reader.take(std::string_view(answer).substr(at, piece));
  Taken taken{reader.state(), {}};
  if (taken.state == AnswerReader::State::complete) taken.out = reader.finished();
  (void)to_text(log);
  return taken;
}

TEST(StepAnswer, ComesInPiecesOfAnySize) {
  const std::string answer = answer_to(everything());
  for (const std::size_t piece : {std::size_t{1}, std::size_t{13}, answer.size()}) {
    const Taken taken = take(answer, piece);
    ASSERT_EQ(taken.state, AnswerReader::State::complete) << piece;
    ASSERT_TRUE(taken.out);
    EXPECT_EQ(taken.out->scene.shapes.size(), 6u);
  }
}

TEST(StepAnswer, ThatIsDamagedIsSoundOrRefused) {
  const std::string answer = answer_to(everything());
  std::size_t refused = 0;
  constexpr std::uint64_t kChanges = 5000;
  for (std::uint64_t i = 0; i < kChanges; ++i) {
    const std::uint64_t random = mixed(i);
    std::string changed = answer;
    if (i % 5 == 0) {
      changed.resize(random % answer.size());
    } else {
      char& byte = changed[random % answer.size()];
      byte = static_cast<char>(byte ^ static_cast<char>(1 + (random >> 40) % 255));
    }
    const Taken taken = take(changed, answer.size());
    if (taken.out) {
      EXPECT_EQ(scene::check(taken.out->scene), "") << i;
      EXPECT_EQ(taken.out->materials.size(), taken.out->scene.materials.size());
    } else {
      ++refused;
    }
  }
  EXPECT_GT(refused, kChanges / 5 - 1);  // what is cut is never whole
}

TEST(StepAnswer, KeepsTheLimits) {
  const std::string answer = answer_to(everything());
  Limits limits;
  limits.nodes = 3;
  EXPECT_EQ(take(answer, 1000, limits).state, AnswerReader::State::damaged);
  limits = {};
  limits.triangles = 10;
  EXPECT_EQ(take(answer, 1000, limits).state, AnswerReader::State::damaged);
}

TEST(StepAnswer, RequestsAreReadBackOrRefused) {
  Request request;
  request.path = "a/b.step";
  request.name = "dir/a/b.step";
  request.limits.depth = 7;
  request.deflection = 0.25;
  request.bytes = 5;
  const std::string whole = request_head(request) + "12345";
  std::string_view bytes = whole;
  const auto back = request_from(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(bytes, "12345");
  EXPECT_EQ(back->path, request.path);
  EXPECT_EQ(back->name, request.name);
  EXPECT_EQ(back->limits.depth, 7u);
  EXPECT_EQ(back->deflection, 0.25);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    bytes = std::string_view(whole).substr(0, size);
    EXPECT_FALSE(request_from(bytes)) << size;
  }
}

}  // namespace
}  // namespace panwright::importers::step::process_test
