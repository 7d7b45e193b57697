#include "analysis/contacts/networks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace throng {
namespace {

/// Number of buffered bytes that are written at once.
constexpr size_t kPiece = 1 << 16;
/// Frames at a whole second belong to the next second, regardless of the rounding of step_s.
constexpr double kRounding_s = 1e-9;

}  // namespace

void SecondsFile::frame(int64_t number, std::span<const uint64_t> pairs) {
  const auto second =
      1 + static_cast<int64_t>(std::floor(static_cast<double>(number) * step_s_ + kRounding_s));
  if (second != second_) write_second();
  second_ = second;
  now_.insert(now_.end(), pairs.begin(), pairs.end());
}

void SecondsFile::write_second() {
  std::sort(now_.begin(), now_.end());
  now_.erase(std::unique(now_.begin(), now_.end()), now_.end());
  std::string text;
  for (const uint64_t pair : now_)
    append(text, "{} {} {}\n", second_, pair >> 32, pair & UINT32_MAX);
  out_.write(text);
  now_.clear();
}

void SecondsFile::end() {
  write_second();
  out_.close();
}

GraphFile::GraphFile(std::filesystem::path file, const RunInfo& run, const Attributes& attributes)
    : out_(std::move(file), kContactsOption) {
  text_ =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n"
      "  <key id=\"group\" for=\"node\" attr.name=\"group\" attr.type=\"string\"/>\n";
  for (size_t i = 0; i < attributes.size(); ++i)
    append(text_, "  <key id=\"e{}\" for=\"edge\" attr.name=\"{}\" attr.type=\"{}\"/>\n", i,
           attributes[i].first, attributes[i].second);
  text_ += "  <graph edgedefault=\"undirected\">\n";
  for (int id = 0; id < run.avatar_count(); ++id) {
    const auto at = static_cast<size_t>(id);
    const std::string group =
        at < run.group_of_avatar.size() ? run.groups[run.group_of_avatar[at]] : "";
    append(text_, "    <node id=\"{}\"><data key=\"group\">{}</data></node>\n", id,
           xml_text(group));
    if (text_.size() < kPiece) continue;
    out_.write(text_);
    text_.clear();
  }
}

void GraphFile::edge(uint64_t pair, const std::vector<std::string>& values) {
  append(text_, "    <edge source=\"{}\" target=\"{}\">", pair >> 32, pair & UINT32_MAX);
  for (size_t i = 0; i < values.size(); ++i)
    append(text_, "<data key=\"e{}\">{}</data>", i, values[i]);
  text_ += "</edge>\n";
  if (text_.size() < kPiece) return;
  out_.write(text_);
  text_.clear();
}

void GraphFile::end() {
  out_.write(text_ + "  </graph>\n</graphml>\n");
  out_.close();
}

TouchingNetwork::TouchingNetwork(const std::filesystem::path& folder, const RunInfo& run)
    : graph_(folder / "touching.graphml"),
      people_(static_cast<uint32_t>(run.avatar_count())),
      seconds_(folder / "touching.tij", run.step_s) {}

void TouchingNetwork::frame(const Frame& frame) {
  pairs_.clear();
  for (const PairKey pair : frame.pairs)
    if (pair.b() < people_) pairs_.push_back(pair_key(pair.a(), pair.b()));
  pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  seconds_.frame(frame.number, pairs_);
}

void TouchingNetwork::ended(const Contact& contact) {
  spells_.add({pair_key(contact.a, contact.b), contact.begin_s, contact.duration_s});
}

void TouchingNetwork::end(const RunInfo& run) {
  seconds_.end();
  GraphFile graph(
      graph_, run,
      {{"contacts", "int"}, {"seconds", "double"}, {"first_s", "double"}, {"spells", "string"}});
  uint64_t pair = 0;  // no pair has this key
  int contacts = 0;
  double seconds = 0, first_s = 0;
  std::string text;
  const auto finish = [&] {
    if (contacts == 0) return;
    graph.edge(pair, {fmt::format("{}", contacts), fmt::format("{:.4f}", seconds),
                      fmt::format("{:.4f}", first_s), text});
    contacts = 0;
    seconds = 0;
    text.clear();
  };
  spells_.for_each([&](const Spell& spell) {
    if (spell.pair != pair) finish();
    pair = spell.pair;
    if (contacts++ == 0) first_s = spell.begin_s;
    seconds += spell.duration_s;
    append(text, "{}{:.4f} {:.4f}", text.empty() ? "" : "; ", spell.begin_s,
           spell.begin_s + spell.duration_s);
  });
  finish();
  graph.end();
}

}  // namespace throng
