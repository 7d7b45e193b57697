#include "viewer/server/proximity_message.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "viewer/server/pair_history.h"

namespace throng {
namespace {

constexpr double kMaxPoint_m = 1e9;  // beyond, a page could not store micrometres

bool is_of(const ProximityPair& row, uint32_t body) {
  return row.pair.a() == body || row.pair.b() == body;
}

bool has_same_bodies(const ProximityPair& p, const ProximityPair& q) {
  return p.pair.a() == q.pair.a() && p.pair.b() == q.pair.b();
}

bool is_nearer(const ProximityPair& p, const ProximityPair& q) {
  return std::tuple(p.pair.a(), p.pair.b(), p.lo_m, p.hi_m, p.pair) <
         std::tuple(q.pair.a(), q.pair.b(), q.lo_m, q.hi_m, q.pair);
}

}  // namespace

std::vector<ProximityPair> nearest_parts(const RunReader& run, std::optional<uint32_t> body) {
  std::vector<ProximityPair> nearest;
  for (const std::span<const ProximityPair> rows : {run.proximity_pairs(), run.closest_parts()})
    for (const ProximityPair& row : rows) {
      if (body && !is_of(row, *body)) continue;
      // Rows of two bodies follow each other: a crowd's many rows need no sorting.
      if (nearest.empty() || !has_same_bodies(nearest.back(), row))
        nearest.push_back(row);
      else if (is_nearer(row, nearest.back()))
        nearest.back() = row;
    }
  std::sort(nearest.begin(), nearest.end(), is_nearer);
  nearest.erase(std::unique(nearest.begin(), nearest.end(), has_same_bodies), nearest.end());
  return nearest;
}

bool has_points(const ProximityPair& row) {
  const auto is_known = [](double x) { return std::fabs(x) < kMaxPoint_m; };
  return std::all_of(row.point_a_m.begin(), row.point_a_m.end(), is_known) &&
         std::all_of(row.point_b_m.begin(), row.point_b_m.end(), is_known);
}

ProximityMessage::ProximityMessage(uint32_t body, int64_t from) {
  head_.body = body;
  head_.from = static_cast<double>(from);
}

void ProximityMessage::add(int64_t frame, std::span<const ProximityPair> rows) {
  for (const ProximityPair& row : rows) {
    const bool is_a = row.pair.a() == head_.body;
    const auto part_a = static_cast<uint8_t>(row.pair.part_a());
    const auto part_b = static_cast<uint8_t>(row.pair.part_b());
    const bool knows_points = has_points(row);
    put(records_,
        ProximityRecord{to_int32(frame), is_a ? row.pair.b() : row.pair.a(), is_a ? part_a : part_b,
                        is_a ? part_b : part_a, static_cast<uint8_t>(row.level),
                        knows_points ? uint8_t{1} : uint8_t{0}, row.lo_m, row.hi_m});
    ++head_.count;
    if (!knows_points) continue;
    for (const auto* point :
         {is_a ? &row.point_a_m : &row.point_b_m, is_a ? &row.point_b_m : &row.point_a_m})
      points_.insert(points_.end(), point->begin(), point->end());
  }
}

Bytes ProximityMessage::finish(int64_t to, bool is_recorded) {
  head_.to = static_cast<double>(to);
  head_.is_recorded = is_recorded ? 1 : 0;
  Bytes out;
  out.reserve(sizeof head_ + records_.size() + points_.size() * sizeof(double) + 8);
  put(out, head_);
  out.insert(out.end(), records_.begin(), records_.end());
  align(out, sizeof(double));
  put_all(out, std::span<const double>(points_));
  return out;
}

void ProximityHistory::add(const RunReader& run) {
  const int64_t frame = run.header()->frame;
  std::vector<ProximityPair> rows = nearest_parts(run);
  const std::lock_guard lock(mutex_);
  if (!entries_.empty() && frame <= entries_.back().frame) return;
  rows_ += rows.size();
  entries_.push_back({frame, std::move(rows)});
  while (rows_ > capacity_ && entries_.size() > 1) {
    rows_ -= entries_.front().rows.size();
    entries_.pop_front();
  }
}

void ProximityHistory::clear() {
  const std::lock_guard lock(mutex_);
  entries_.clear();
  rows_ = 0;
}

Bytes ProximityHistory::of(uint32_t body, int64_t since) const {
  ProximityMessage message(body, since);
  const std::lock_guard lock(mutex_);
  std::vector<ProximityPair> own;
  for (const Entry& entry : entries_) {
    if (entry.frame < since) continue;
    own.clear();
    for (const ProximityPair& row : entry.rows)
      if (is_of(row, body)) own.push_back(row);
    message.add(entry.frame, own);
  }
  const bool is_recorded = !entries_.empty();
  return message.finish(is_recorded ? std::max(since, entries_.back().frame + 1) : since,
                        is_recorded);
}

}  // namespace throng
