// The canonical form of large texts, and scenes written as text.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/text.h"
#include "bench/bench.h"
#include "pxn/format.h"
#include "pxn/pxn.h"
#include "pxn/writer.h"

namespace panwright::bench::case_text {

namespace {

// Numbers that look like those of CAD exports: six decimals.
class Numbers {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 44) * 1e-6;
  }

 private:
  std::uint64_t state_ = 1;
};

// Vertices, an element each.
std::string elements(std::size_t bytes) {
  Numbers n;
  std::string out = "<pangu_model ver=\"1\"><mesh><positions>\n";
  while (out.size() < bytes)
    out += fmt::format("<vec3>{:.6f} {:.6f}  {:.6f}</vec3>\n", n.next(), n.next(), n.next());
  return out + "</positions><tristrips><tristrip>0 1 2</tristrip></tristrips></mesh></pangu_model>";
}

// Shapes with attributes.
std::string shapes(std::size_t bytes) {
  Numbers n;
  std::string out = "<pangu_model ver='1'>\n";
  for (std::size_t i = 0; out.size() < bytes; ++i)
    out += fmt::format(
        "<cylinder radius='{:.6f}' height='{}mm' name='bolt{}' translate='{:.6f} {{{}*2}} 0'/>\n",
        n.next() + 0.1, i % 100 + 1, i, n.next(), i % 10);
  return out + "</pangu_model>";
}

// One list.
std::string list(std::size_t bytes) {
  Numbers n;
  std::string out = "<pangu_model ver='1'><tube radius='1e-9'><path>";
  while (out.size() < bytes)
    out += fmt::format("{:.6f} {:.6f} {:.6f}\n", n.next(), n.next(), n.next());
  return out + "</path></tube></pangu_model>";
}

// All decimal numbers of a text, sorted: attributes change places.
std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> out;
  for (std::size_t i = 0; (i = text.find_first_of("0123456789", i)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789.", i), text.size());
    out.push_back(parse_double(std::string_view(text).substr(i, end - i)).value_or(-1));
    i = end;
  }
  std::sort(out.begin(), out.end());
  return out;
}

double differing(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return 1;
  double count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] == b[i] ? 0 : 1;
  return count;
}

std::string formatted(const std::shared_ptr<const std::string>& text) {
  DiagnosticLog log;
  auto out = pxn::formatted("bench", text, {}, log);
  return out ? std::move(*out) : std::string();
}

void run_format(Context& context, std::size_t bytes) {
  const struct {
    const char* what;
    std::string text;
  } texts[] = {
      {"elements", elements(bytes)}, {"attributes", shapes(bytes)}, {"one-list", list(bytes)}};
  std::vector<std::shared_ptr<const std::string>> shared;
  std::vector<std::string> results(std::size(texts));
  std::vector<Variant> variants;
  for (std::size_t i = 0; i < std::size(texts); ++i) {
    shared.push_back(std::make_shared<const std::string>(texts[i].text));
    variants.push_back({texts[i].what, [&, i] { results[i] = formatted(shared[i]); }});
  }
  const std::vector<Timing> timings = interleaved(variants, context.runs());
  for (std::size_t i = 0; i < std::size(texts); ++i) {
    Row row{.case_name = "text",
            .setting = fmt::format("fmt of={} bytes={}", texts[i].what, texts[i].text.size()),
            .speed_unit = "MB/s",
            .error = differing(numbers_of(texts[i].text), numbers_of(results[i])),
            .error_unit = "numbers",
            .reference = "the numbers of the text",
            .must = 20,
            .must_error = 0.5};
    set_rate(row, timings[i], 1e-6 * static_cast<double>(texts[i].text.size()));
    context.add(row);
  }
}

void run_expand(Context& context, std::size_t bytes) {
  DiagnosticLog log;
  const pxn::MemoryFile file{"m.pxn", shapes(bytes)};
  const auto scene = pxn::read_memory(std::span(&file, 1), {}, log);
  if (!scene) {
    context.note("expand: the text could not be read");
    return;
  }
  std::string text;
  const Timing timing = timed([&] { text = pxn::to_text(*scene); }, context.runs());
  const pxn::MemoryFile written{"m.pxn", text};
  const auto again = pxn::read_memory(std::span(&written, 1), {}, log);
  const bool same = again && pxn::scene_difference(*scene, *again, pxn::Likeness::same).empty();
  Row row{.case_name = "text",
          .setting = fmt::format("expand nodes={} bytes={}", scene->nodes.size(), text.size()),
          .speed_unit = "MB/s",
          .error = same ? 0.0 : 1.0,
          .error_unit = "scenes",
          .reference = "the scene read again",
          .must_error = 0.5};
  set_rate(row, timing, 1e-6 * static_cast<double>(text.size()));
  context.add(row);
}

void run(Context& context) {
  const std::size_t bytes = context.quick() ? 200'000 : 10'000'000;
  run_format(context, bytes);
  run_expand(context, bytes / 2);
}

const bool kAdded = add_case({"text", "the canonical form of a text, and a scene as text", run});

}  // namespace

}  // namespace panwright::bench::case_text
