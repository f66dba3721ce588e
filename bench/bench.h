// Benchmarks: cases and their reports.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace panwright::bench {

// Row of a result: speed, error and reference. No speed stands without an error.
struct Row {
  std::string case_name;
  std::string setting;  // varied parameters, as "triangles=11880 samples=4"
  double speed = 0;
  std::string speed_unit;  // "Mtri/s", "ms/frame"…
  double error = 0;
  std::string error_unit;      // "m", "relative", "px", "ulp"…
  std::string reference;       // reference of the error
  double reference_error = 0;  // uncertainty of the reference, in error_unit
  int runs = 0;                // of which speed is the median
  double spread = 0;           // half the distance between the quartiles of speed, in speed_unit
  double must = 0;             // the bound of the project on the speed (see must_is_least); 0: none
  bool must_is_least = true;   // true: speed must be at least `must`; false: at most
  double must_error = 0;       // the bound on the error; 0: none
};

// Environment of a case.
class Context {
 public:
  Context(bool quick, std::filesystem::path program_folder);

  bool quick() const { return quick_; }  // a smoke test: small sizes, few runs
  int runs() const { return quick_ ? 3 : 11; }

  // A folder for files of this run, removed at its end.
  const std::filesystem::path& scratch() const { return scratch_; }
  // A program built beside this one, for cases that time whole processes. Empty: not built.
  std::filesystem::path program(std::string_view name) const;
  // A file of the source tree, as "examples/paper/figure8.pxn". Empty: not there.
  std::filesystem::path source(std::string_view path) const;

  void add(Row row);
  // Adds a remark for readers that no row can hold, as the reason for a missing case.
  void note(std::string text);
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<std::string>& notes() const { return notes_; }
  // Shown in the header of results that used OpenGL.
  void set_renderer(std::string renderer) { renderer_ = std::move(renderer); }
  const std::string& renderer() const { return renderer_; }

  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

 private:
  bool quick_;
  std::filesystem::path programs_;
  std::filesystem::path scratch_;
  std::vector<Row> rows_;
  std::vector<std::string> notes_;
  std::string renderer_ = "none";
};

struct Case {
  std::string name;  // also the name of the file of results
  std::string what;  // one line
  std::function<void(Context&)> run;
};

// Puts a case on the list; one file, one case:
//   const bool kAdded = add_case({"sphere", "tessellation of spheres", run_sphere});
bool add_case(Case one);
const std::vector<Case>& cases();  // by name

// ---- timing

struct Variant {
  std::string setting;
  std::function<void()> work;
  std::function<void()> before = {};  // if given: called each time before work, not timed
};

struct Timing {
  double median = 0;  // seconds
  double lower_quartile = 0;
  double upper_quartile = 0;
  int runs = 0;
};

// Measures processor time of all threads from now on, for machines that others use: of this process
// alone.
void use_processor_time();
bool uses_processor_time();

// Times variants in turn (1 2 3, 1 2 3, …), so that whatever else the machine does falls on all
// of them. Each runs once more before, untimed. One Timing for each variant.
std::vector<Timing> interleaved(const std::vector<Variant>& variants, int runs);
Timing timed(const std::function<void()>& work, int runs);

// Fills in speed, spread and runs: `amount` of work a run, as "Mtri/s" from millions of triangles.
void set_rate(Row& row, const Timing& timing, double amount);
// The same for seconds · factor, as "ms" with 1e3.
void set_time(Row& row, const Timing& timing, double factor);

// Starts a program and waits. Returns its exit code, or −1 when it could not run; peak_bytes: its
// largest resident set. Standard output is dropped.
int run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                double* peak_bytes = nullptr);

}  // namespace panwright::bench
