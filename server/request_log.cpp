#include "server/request_log.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "base/hash.h"

namespace panwright::server {

namespace {

std::string hash_of(std::span<const std::uint8_t> bytes) {
  return hash128(std::as_bytes(bytes)).hex();
}

std::string hex_of(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  out.reserve(2 * bytes.size());
  for (const std::uint8_t byte : bytes) {
    out += kDigits[byte >> 4];
    out += kDigits[byte & 15];
  }
  return out;
}

// Nothing: other characters.
std::optional<Bytes> bytes_of_hex(const std::string& text) {
  if (text.size() % 2 != 0) return std::nullopt;
  const auto digit = [](char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
  };
  Bytes out;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const int high = digit(text[i]), low = digit(text[i + 1]);
    if (high < 0 || low < 0) return std::nullopt;
    out.push_back(static_cast<std::uint8_t>(16 * high + low));
  }
  return out;
}

}  // namespace

Result<std::unique_ptr<RequestLog>> RequestLog::create(const std::filesystem::path& path,
                                                       DiagnosticLog& log) {
  auto out = std::make_unique<RequestLog>();
  out->file_.open(path, std::ios::binary | std::ios::trunc);
  if (!out->file_) {
    log.report_file(Code("E0103"), path.string(), "the log cannot be written");
    return failed;
  }
  return out;
}

void RequestLog::begin(std::uint64_t session, std::uint64_t state) {
  file_ << fmt::format("{{\"session\":{},\"state\":{}}}\n", session, state) << std::flush;
}

void RequestLog::add(std::uint64_t session, std::span<const std::uint8_t> request,
                     const Reply& reply) {
  const RequestKind* const kind = request_kind(word_at(request));
  nlohmann::ordered_json line;
  line["session"] = session;
  line["name"] = kind != nullptr ? kind->name : "unknown";
  line["request"] = hex_of(request);
  line["bytes"] = reply.bytes.size();
  line["reply"] = hash_of(reply.bytes);
  if (!reply.note.empty()) line["note"] = reply.note;
  file_ << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n'
        << std::flush;
}

Result<Replayed> replay(const std::filesystem::path& path, Stage& stage,
                        const SessionOptions& options, DiagnosticLog& log, const Job& job) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    log.report_file(Code("E0101"), path.string(), "the log cannot be opened");
    return failed;
  }
  Replayed out;
  std::map<std::uint64_t, std::shared_ptr<State>> states;
  std::map<std::uint64_t, std::unique_ptr<Session>> sessions;
  std::string text;
  for (std::uint64_t number = 1; std::getline(file, text); ++number) {
    if (job.cancelled()) {
      report_cancelled(log);
      return failed;
    }
    const auto line = nlohmann::json::parse(text, nullptr, false);
    const bool begins = line.is_object() && line.contains("state");
    const auto request = line.is_object() && line.contains("request") && line["request"].is_string()
                             ? bytes_of_hex(line["request"].get<std::string>())
                             : std::nullopt;
    const bool sound =
        line.is_object() && line.contains("session") && line["session"].is_number_unsigned() &&
        (begins
             ? line["state"].is_number_unsigned()
             : request && line.contains("reply") && line["reply"].is_string() &&
                   request_size(*request, request->size()).state == RequestSize::State::complete &&
                   sessions.contains(line["session"].get<std::uint64_t>()));
    if (!sound) {
      log.report_file(Code("E0102"), path.string(),
                      fmt::format("line {} is not one of a log of requests", number));
      return failed;
    }
    const auto session = line["session"].get<std::uint64_t>();
    if (begins) {
      auto& state = states[line["state"].get<std::uint64_t>()];
      if (state == nullptr) state = std::make_shared<State>(stage.initial());
      sessions[session] = std::make_unique<Session>(stage, state, options);
      ++out.sessions;
      continue;
    }
    const Reply reply = sessions[session]->answer(*request, job);
    if (job.cancelled()) continue;
    ++out.requests;
    if (hash_of(reply.bytes) == line["reply"].get<std::string>()) continue;
    if (out.different++ == 0)
      out.first = fmt::format("line {} ({})", number, line.value("name", std::string("unknown")));
  }
  return out;
}

}  // namespace panwright::server
