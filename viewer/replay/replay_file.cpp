#include "viewer/replay/replay_file.h"

#include <fmt/format.h>
#include <glib.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/errors.h"
#include "base/files/whole_file.h"
#include "lcm_io/log/log_gaps.h"
#include "viewer/picture/recorded_frame.h"

namespace throng {
namespace {

constexpr std::string_view kMarker = "<!--RECORDING-->";

Bytes deflated(const Bytes& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  Bytes out(size);
  if (compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()), 9) != Z_OK)
    throw EnvironmentError("zlib could not compress the recording: out of memory");
  out.resize(size);
  return out;
}

std::string base64(const Bytes& bytes) {
  const std::unique_ptr<gchar, void (*)(void*)> text(g_base64_encode(bytes.data(), bytes.size()),
                                                     g_free);
  return text.get();
}

}  // namespace

ReplayReport write_replay(ReplayRecorder& recorder, const std::filesystem::path& html,
                          std::string_view page, double limit_mb, const std::string& problem) {
  if (!recorder.has_keys())
    throw InputError(html.string(), "a run with people in it to record", "no frame");
  const size_t marker = page.find(kMarker);
  const std::string recording = base64(deflated(recorder.finish(problem)));
  std::string text(page.substr(0, marker));
  text += "<script type=\"text/plain\" id=\"recording\">";
  text += recording;
  text += "</script>";
  text += page.substr(marker + kMarker.size());
  const double mb = static_cast<double>(text.size()) * 1e-6;
  if (mb > limit_mb) {
    const double room = limit_mb - static_cast<double>(page.size()) * 1e-6;
    const double share = std::max(0.0, room / (static_cast<double>(recording.size()) * 1e-6));
    throw InputError(
        html.string(), fmt::format("at most {:g} MB (--html-limit-mb)", limit_mb),
        fmt::format("{:.1f} MB for {} people over {:.1f} s; {:.1f} s of them would fit", mb,
                    recorder.avatars(), recorder.seconds(), 0.95 * share * recorder.seconds()));
  }
  write_whole_file(html, text);
  return {text.size(), recorder.avatars(), recorder.seconds(), problem};
}

ReplayReport write_replay(const std::filesystem::path& log, const std::filesystem::path& html,
                          std::string_view page, double limit_mb) {
  LogReader reader(log);
  ReplayRecorder recorder;
  LogGaps gaps;
  LogEvent event;
  while (gaps.next(reader, event)) recorder.take(event.channel, event.data);
  const run_description_t* run = recorder.run();
  if (run == nullptr)
    throw InputError(log.string(), "a run's description", gaps.found_no_description());
  require_people(*run, log.string());
  if (!recorder.has_keys())
    throw InputError(log.string(), "a log with states to show",
                     "none; " + gaps.describe(run->step_s));
  return write_replay(recorder, html, page, limit_mb, gaps.describe(run->step_s));
}

ReplaySink::ReplaySink(const std::filesystem::path& html, std::string_view page, double limit_mb)
    : html_(html), page_(page), limit_mb_(limit_mb) {}

void ReplaySink::begin(const RunInfo& run) {
  if (run.avatar_count() == 0)
    throw InputError(html_.string(), "a run with people or robots in it to show",
                     fmt::format("nobody in '{}'", run.scene->name));
  const double every = std::max(1.0, std::round(kReplayKeyPeriod_s / run.step_s));
  encoder_.emplace(EncoderOptions{.state_every = every}, static_cast<MessageTarget&>(*this));
  encoder_->begin(run);
  for (int chunk = 0; chunk < encoder_->outlet().description_chunks(); ++chunk)
    encoder_->outlet().send_description_chunk(chunk);
}

void ReplaySink::frame(const RunInfo& run, const Frame& frame) { encoder_->frame(run, frame); }

void ReplaySink::end(const RunInfo& run, const RunEnd& end) {
  encoder_->end(run, end);
  try {
    report_ = write_replay(recorder_, html_, page_, limit_mb_);
  } catch (const InputError& error) {
    // The run was fine; only this file of it cannot be had.
    throw EnvironmentError(error.what());
  }
}

void ReplaySink::message(Channel channel, int64_t, std::span<const uint8_t> bytes) {
  recorder_.take(name_of(channel), bytes);
}

}  // namespace throng
