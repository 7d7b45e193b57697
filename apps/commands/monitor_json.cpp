#include <fmt/format.h>

#include <algorithm>

#include "apps/commands/monitor_view.h"
#include "bench/version_json.h"
#include "lcm_io/codec/description.h"

namespace throng {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kNewest = 64;

std::string hash_text(int64_t hash) { return fmt::format("{:016x}", static_cast<uint64_t>(hash)); }

/// Number of messages that the run sent on a channel; null before THRONG_END. Checksums follow
/// THRONG_END, so their number comes from the last one.
Json sent_on(Channel channel, const RunReader& run) {
  if (!run.end()) return nullptr;
  if (channel == Channel::kChecksums && run.checks() && run.checks()->is_last != 0)
    return run.checks()->seq + 1;
  const std::vector<std::string>& names = run.end()->channels;
  const auto found = std::find(names.begin(), names.end(), name_of(channel));
  if (found == names.end()) return 0;
  return run.end()->messages[static_cast<size_t>(found - names.begin())];
}

Json channels_of(const MonitorView& view, const Monitor::Totals& totals) {
  Json out = Json::object();
  const double span = std::max(totals.now_s, 1e-9);
  for (const Channel channel : kAllChannels) {
    const ChannelTally& tally = view.inbox.run().tally(channel);
    const auto i = static_cast<size_t>(channel);
    out[std::string(name_of(channel))] = {
        {"messages", tally.messages},
        {"bytes", tally.bytes},
        {"per_s", static_cast<double>(totals.messages[i]) / span},
        {"bytes_per_s", static_cast<double>(totals.bytes[i]) / span},
        {"last_frame", tally.last_frame},
        {"missing", tally.missing},
        {"before", tally.before},
        {"late", tally.late},
        {"repeated", tally.repeated},
        {"incomplete", tally.incomplete},
        {"sent", sent_on(channel, view.inbox.run())},
        {"rejected", view.inbox.totals(channel).rejected},
        {"rejection", printable(view.inbox.totals(channel).rejection)}};
  }
  return out;
}

Json run_of(const MonitorView& view) {
  const RunReader& run = view.inbox.run();
  if (view.inbox.runs().empty()) return nullptr;
  Json out = {{"run_id", hash_text(run.run_id())},
              {"instance", hash_text(run.instance())},
              {"from_start", run.tally().from_start},
              {"ended", run.end().has_value()}};
  if (run.run() != nullptr) {
    out["scene"] = printable(run.run()->scene);
    out["seed"] = run.run()->seed;
    out["avatars"] = run.run()->avatar_count;
    out["part_volume"] = printable(run.run()->part_volume);
  }
  if (run.frame_stats()) {
    out["frame"] = run.frame_stats()->frame;
    out["simulated_s"] = static_cast<double>(run.frame_stats()->utime) * 1e-6;
  }
  return out;
}

Json others_of(const MonitorView& view) {
  Json out = Json::array();
  for (const RunTally& run : view.inbox.runs()) {
    const RunReader& followed = view.inbox.run();
    if (run.run_id == followed.run_id() && run.instance == followed.instance()) continue;
    int64_t messages = 0;
    for (const ChannelTally& tally : run.channels) messages += tally.messages;
    out.push_back({{"run_id", hash_text(run.run_id)},
                   {"instance", hash_text(run.instance)},
                   {"messages", messages},
                   {"missing", lost_of(run)},
                   {"ended", run.ended}});
  }
  return out;
}

Json stages_of(const CostTerms& terms) {
  Json out = Json::array();
  for (const CostTerms::Stage& stage : terms.stages)
    out.push_back({{"volume", stage.volume},
                   {"N_u", stage.n_u},
                   {"C_u_ns", stage.c_u_ns},
                   {"N_v", stage.n_v},
                   {"C_v_ns", stage.c_v_ns},
                   {"passed", stage.passed}});
  return out;
}

}  // namespace

Json json_of(const MonitorView& view) {
  const Monitor::Totals totals =
      view.overall ? view.monitor.overall(view.now_s) : view.monitor.recent(view.now_s);
  const CostTerms terms = cost_terms(totals, view.inbox.run().run());
  const Monitor::FrameTime frame = view.monitor.frame_time();
  Json json;
  json["throng"] = version_json();
  json["source"] = view.source;
  json["listened_s"] = totals.now_s;
  json["run"] = run_of(view);
  json["lost"] = lost_of(view.inbox.run().tally());
  json["rejected"] = view.inbox.rejected();
  json["other_messages"] = view.inbox.others();
  json["other_runs"] = others_of(view);
  json["channels"] = channels_of(view, totals);
  json["frames"] = totals.frames;
  json["frame_ms"] = {{"last", frame.last_ms}, {"median", frame.median_ms}};
  json["stages"] = stages_of(terms);
  json["N_p"] = terms.n_p;
  json["C_p_ns"] = terms.c_p_ns;
  json["C_o_ns"] = terms.c_o_ns;
  json["T_ns"] = terms.t_ns;
  json["touching"] = view.inbox.run().touching().size();
  json["events"] = {{"begin", totals.begins}, {"end", totals.ends}};
  json["parts"] = Json::object();
  for (const Monitor::PartTotal& part : view.monitor.parts())
    json["parts"][part.name] = {
        {"begins", part.begins}, {"touching", part.touching}, {"contact_s", part.contact_s}};
  json["newest"] = Json::array();
  const std::deque<Monitor::Note>& notes = view.monitor.notes();
  for (size_t i = notes.size() - std::min(notes.size(), kNewest); i < notes.size(); ++i) {
    const Monitor::Note& note = notes[i];
    json["newest"].push_back({{"time_s", static_cast<double>(note.utime_us) * 1e-6},
                              {"kind", note.kind == EventKind::kBegin ? "begin" : "end"},
                              {"text", text_of(note, view.inbox.run().run())},
                              {"level", static_cast<int>(note.level)}});
  }
  return json;
}

}  // namespace throng
