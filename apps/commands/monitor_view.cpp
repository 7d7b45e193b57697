#include "apps/commands/monitor_view.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "lcm_io/codec/description.h"

namespace throng {
namespace {

constexpr size_t kExact = kCullingStageCount - 1;

double per(double total, double count) { return count > 0 ? total / count : 0; }
double per_frame(int64_t total, const Monitor::Totals& totals) {
  return per(static_cast<double>(total), static_cast<double>(totals.frames));
}

Monitor::Totals totals_of(const MonitorView& view) {
  return view.overall ? view.monitor.overall(view.now_s) : view.monitor.recent(view.now_s);
}

/// Seconds that rates refer to; for a log, simulation time.
double span_of(const Monitor::Totals& totals) { return std::max(totals.now_s, 1e-9); }

std::string clock_ns(double ns) { return ns > 0 ? fmt::format("{:.1f}", ns) : "-"; }

/// "60.0 frames/s, a frame 1.00 ms, median 0.74; 24 pairs touch"
std::string frames_text(const MonitorView& view, const Monitor::Totals& totals) {
  const Monitor::FrameTime frame = view.monitor.frame_time();
  return fmt::format("{:.1f} frames/s{}; {}", static_cast<double>(totals.frames) / span_of(totals),
                     frame.last_ms > 0 ? fmt::format(", a frame {:.2f} ms, median {:.2f}",
                                                     frame.last_ms, frame.median_ms)
                                       : "",
                     counted(view.inbox.run().touching().size(), "pair touches", "pairs touch"));
}

/// "42.3 begin and 35.3 end per second"
std::string changes_text(const Monitor::Totals& totals) {
  const double span = span_of(totals);
  return fmt::format("{:.1f} begin and {:.1f} end per second",
                     static_cast<double>(totals.begins) / span,
                     static_cast<double>(totals.ends) / span);
}

std::vector<std::string> note_lines(const MonitorView& view, size_t max_lines) {
  std::vector<std::string> lines = {"newest contacts"};
  const std::deque<Monitor::Note>& notes = view.monitor.notes();
  for (auto note = notes.rbegin(); note != notes.rend() && lines.size() < max_lines; ++note)
    lines.push_back(fmt::format("{:>9.3f} s  {}", static_cast<double>(note->utime_us) * 1e-6,
                                text_of(*note, view.inbox.run().run())));
  return lines;
}

}  // namespace

int64_t lost_of(const RunTally& run) {
  int64_t lost = 0;
  for (const ChannelTally& tally : run.channels) lost += tally.missing;
  return lost;
}

std::string title_of(const MonitorView& view) {
  const RunReader& run = view.inbox.run();
  if (view.inbox.runs().empty()) return "waiting for a run on " + view.source;
  const std::optional<frame_stats_t>& stats = run.frame_stats();
  std::string what = "a run whose description is not received yet";
  if (run.run() != nullptr)
    what = fmt::format("{}, seed {}, {}", printable(run.run()->scene), run.run()->seed,
                       counted(run.run()->avatar_count, "avatar"));
  std::string text = fmt::format("{} - run {:016x}", what, static_cast<uint64_t>(run.run_id()));
  if (stats)
    text += fmt::format(" - frame {}, {:.2f} s", stats->frame,
                        static_cast<double>(stats->utime) * 1e-6);
  if (run.end()) text += " - ended";
  return text;
}

std::vector<std::string> rate_lines(const MonitorView& view) {
  const Monitor::Totals totals = totals_of(view);
  const size_t runs = view.inbox.runs().size();
  return {frames_text(view, totals),
          fmt::format("{}; lost {}, rejected {}, other runs {}", changes_text(totals),
                      lost_of(view.inbox.run().tally()), view.inbox.rejected(),
                      runs > 1 ? runs - 1 : 0)};
}

std::vector<std::string> channel_lines(const MonitorView& view) {
  const Monitor::Totals totals = totals_of(view);
  std::vector<std::string> lines;
  lines.push_back(fmt::format("{:<21}{:>10}{:>10}{:>11}{:>12}{:>9}{:>9}{:>9}", "channel",
                              "messages", "per s", "kB/s", "last frame", "missing", "before",
                              "rejected"));
  for (const Channel channel : kAllChannels) {
    const ChannelTally& tally = view.inbox.run().tally(channel);
    const Inbox::ChannelTotals& all = view.inbox.totals(channel);
    if (all.messages == 0 && tally.missing == 0) continue;
    const auto i = static_cast<size_t>(channel);
    lines.push_back(fmt::format("{:<21}{:>10}{:>10.1f}{:>11.1f}{:>12}{:>9}{:>9}{:>9}",
                                name_of(channel), tally.messages,
                                static_cast<double>(totals.messages[i]) / span_of(totals),
                                static_cast<double>(totals.bytes[i]) * 1e-3 / span_of(totals),
                                tally.last_frame, tally.missing, tally.before, all.rejected));
  }
  const size_t runs = view.inbox.runs().size();
  lines.push_back(fmt::format("lost {}, rejected {}, on other channels {}, other runs {}",
                              lost_of(view.inbox.run().tally()), view.inbox.rejected(),
                              view.inbox.others(), runs > 1 ? runs - 1 : 0));
  return lines;
}

std::vector<std::string> stage_lines(const MonitorView& view) {
  const Monitor::Totals totals = totals_of(view);
  std::vector<std::string> lines;
  const CostTerms terms = cost_terms(totals, view.inbox.run().run());
  lines.push_back(fmt::format("{:<10}{:>12}{:>10}{:>12}{:>10}{:>12}", "a frame", "N_u", "C_u ns",
                              "N_v", "C_v ns", "passed"));
  for (const CostTerms::Stage& stage : terms.stages)
    lines.push_back(fmt::format("{:<10}{:>12.0f}{:>10}{:>12.0f}{:>10}{:>12.0f}", stage.volume,
                                stage.n_u, clock_ns(stage.c_u_ns), stage.n_v,
                                clock_ns(stage.c_v_ns), stage.passed));
  const auto ms = [](double ns) {
    return ns > 0 ? fmt::format("{:.3f} ms", ns * 1e-6) : std::string("-");
  };
  lines.push_back(fmt::format("N_p {:.0f}, C_p {} ns, C_o {}, T {}", terms.n_p,
                              clock_ns(terms.c_p_ns), ms(terms.c_o_ns), ms(terms.t_ns)));
  return lines;
}

std::vector<std::string> part_lines(const MonitorView& view, size_t max_lines) {
  std::vector<std::string> lines = {
      fmt::format("{:<16}{:>9}{:>10}{:>11}", "part", "begins", "touching", "contact s")};
  for (const Monitor::PartTotal& part : view.monitor.parts()) {
    if (lines.size() == max_lines) break;
    lines.push_back(fmt::format("{:<16.16}{:>9}{:>10}{:>11.1f}", display_name(part.name),
                                part.begins, part.touching, part.contact_s));
  }
  return lines;
}

std::string text_of(const Monitor::Note& note, const run_description_t* run) {
  const auto side = [run](uint32_t body, uint32_t part) {
    if (run == nullptr) return fmt::format("body {} part {}", body, part);
    const std::string name = part_name(*run, body, part);
    return body_name(*run, body) + (name.empty() ? "" : " " + display_name(name));
  };
  std::string text =
      side(note.pair.a(), note.pair.part_a()) + " - " + side(note.pair.b(), note.pair.part_b());
  if (note.kind == EventKind::kBegin) return text + " touch";
  return note.lasted_s >= 0 ? text + fmt::format(", {:.1f} s", note.lasted_s) : text + " part";
}

CostTerms cost_terms(const Monitor::Totals& totals, const run_description_t* run) {
  const std::string part_volume = run != nullptr ? printable(run->part_volume) : "part";
  const std::string names[] = {"sphere", "body box", "box", part_volume};
  CostTerms terms;
  for (size_t i = 0; i < kExact; ++i) {
    if (totals.updates[i] == 0 && totals.tests[i] == 0) continue;
    CostTerms::Stage stage;
    stage.volume = names[i];
    stage.n_u = per_frame(totals.updates[i], totals);
    stage.c_u_ns = per(totals.update_ns[i], static_cast<double>(totals.updates[i]));
    stage.n_v = per_frame(totals.tests[i], totals);
    stage.c_v_ns = per(totals.test_ns[i], static_cast<double>(totals.tests[i]));
    stage.passed = per_frame(totals.passed[i], totals);
    terms.t_ns += stage.n_u * stage.c_u_ns + stage.n_v * stage.c_v_ns;
    terms.stages.push_back(stage);
  }
  terms.n_p = per_frame(totals.tests[kExact], totals);
  terms.c_p_ns = per(totals.update_ns[kExact] + totals.test_ns[kExact],
                     static_cast<double>(totals.tests[kExact]));
  terms.c_o_ns = per(totals.other_ns, static_cast<double>(totals.frames));
  terms.t_ns += terms.n_p * terms.c_p_ns + terms.c_o_ns;
  return terms;
}

std::vector<std::string> lines_of(const MonitorView& view) {
  const Monitor::Totals totals = totals_of(view);
  std::vector<std::string> lines = {title_of(view)};
  if (!view.inbox.runs().empty()) {
    const auto add_section = [&lines](const std::vector<std::string>& section) {
      lines.emplace_back();
      lines.insert(lines.end(), section.begin(), section.end());
    };
    add_section(channel_lines(view));
    add_section({fmt::format("{}, {}", frames_text(view, totals), changes_text(totals))});
    add_section(stage_lines(view));
    const auto left =
        static_cast<size_t>(std::max(2, view.height - static_cast<int>(lines.size()) - 1));
    const std::vector<std::string> parts = part_lines(view, std::max<size_t>(2, left / 2));
    add_section(parts);
    add_section(note_lines(view, left > parts.size() + 1 ? left - parts.size() - 1 : 2));
  }
  if (lines.size() > static_cast<size_t>(view.height))
    lines.resize(static_cast<size_t>(view.height));
  for (std::string& line : lines)
    if (line.size() > static_cast<size_t>(view.width)) line.resize(static_cast<size_t>(view.width));
  return lines;
}

std::string line_of(const MonitorView& view) {
  if (view.inbox.runs().empty()) return title_of(view);
  const Monitor::Totals totals = totals_of(view);
  const double span = span_of(totals);
  double bytes = 0;
  for (const int64_t channel : totals.bytes) bytes += static_cast<double>(channel);
  const RunReader& run = view.inbox.run();
  return fmt::format(
      "frame {}, {:.2f} s: {:.1f} frames/s, {:.1f} kB/s, {} touch, {:.1f} begin/s, {:.1f} end/s, "
      "frame {:.2f} ms, lost {}, rejected {}{}",
      run.frame_stats() ? run.frame_stats()->frame : -1,
      run.frame_stats() ? static_cast<double>(run.frame_stats()->utime) * 1e-6 : 0.0,
      static_cast<double>(totals.frames) / span, bytes * 1e-3 / span, run.touching().size(),
      static_cast<double>(totals.begins) / span, static_cast<double>(totals.ends) / span,
      view.monitor.frame_time().last_ms, lost_of(run.tally()), view.inbox.rejected(),
      run.end() ? ", ended" : "");
}

}  // namespace throng
