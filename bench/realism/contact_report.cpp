#include "bench/realism/contact_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "analysis/measures/measure_table.h"

namespace throng::realism {
namespace {

std::string number(double value, int digits) {
  return std::isnan(value) ? "-" : fmt::format("{:.{}f}", value, digits);
}

/// Both people have a contact.
double per_person_min(uint64_t contacts, double person_s) {
  return person_s > 0 ? 2 * static_cast<double>(contacts) / person_s * 60
                      : std::numeric_limits<double>::quiet_NaN();
}

/// What a table says of a level, from the sums of those contacts whose heads stayed apart.
struct Column {
  std::string name;
  int digits;
  std::function<double(const ContactLevel&, const ContactTally&)> value;
};

Column depth_column(const std::string& name, double share) {
  return {name, 1, [share](const ContactLevel&, const ContactTally& tally) {
            return 100 * tally.depths.quantile(share);
          }};
}

Column rate_column(const std::string& name, uint64_t ContactTally::*count, int digits) {
  return {name, digits, [count](const ContactLevel& level, const ContactTally& tally) {
            return per_person_min(tally.*count, level.person_s);
          }};
}

const std::vector<Column>& columns() {
  static const std::vector<Column> all = {
      rate_column("contacts", &ContactTally::contacts, 2),
      depth_column("50 %", 0.5),
      depth_column("90 %", 0.9),
      depth_column("99 %", 0.99),
      depth_column("most", 1),
      rate_column("trunks", &ContactTally::trunks, 3),
      rate_column("hand in", &ContactTally::hands_in, 3),
      rate_column("deep", &ContactTally::hands_deep, 3),
      {"touch %", 0, [](const ContactLevel& level, const ContactTally& tally) {
         // Of all contacts; who is near whom is not asked for.
         return &tally == level.apart.data() && level.person_s > 0
                    ? 100 * level.touching_s / level.person_s
                    : std::numeric_limits<double>::quiet_NaN();
       }}};
  return all;
}

std::string cell(const std::string& before, const std::string* after) {
  return after == nullptr ? fmt::format("{:>9}", before)
                          : fmt::format("{:>8} >{:>7}", before, *after);
}

std::string level_line(const std::string& name, const ContactLevel& before,
                       const ContactLevel* after, size_t apart) {
  if (!(before.person_s > 0) && (after == nullptr || !(after->person_s > 0))) return "";
  const std::string after_s = after == nullptr ? "" : number(after->person_s, 0);
  std::string line = fmt::format(
      "  {:<13}{}", name, cell(number(before.person_s, 0), after == nullptr ? nullptr : &after_s));
  for (const Column& column : columns()) {
    const std::string then =
        after == nullptr ? "" : number(column.value(*after, after->apart[apart]), column.digits);
    line += cell(number(column.value(before, before.apart[apart]), column.digits),
                 after == nullptr ? nullptr : &then);
  }
  return line + "\n";
}

std::string block(const ContactSums& before, const ContactSums* after, size_t apart) {
  const bool is_pair = after != nullptr;
  std::string text = fmt::format("  {:<13}{:>{}}", "per m2", "person s", is_pair ? 17 : 9);
  for (const Column& column : columns())
    text += fmt::format("{:>{}}", column.name, is_pair ? 17 : 9);
  text += "\n";
  const auto& bounds = ContactMeasures::kBounds_per_m2;
  for (size_t i = 0; i < ContactSums::kLevels; ++i)
    text += level_line(range_text(i == 0 ? 0 : bounds[i - 1],
                                  i < bounds.size() ? std::optional(bounds[i]) : std::nullopt),
                       before.levels[i], is_pair ? &after->levels[i] : nullptr, apart);
  const ContactLevel all_before = before.all();
  const ContactLevel all_after = is_pair ? after->all() : ContactLevel();
  return text + level_line("all", all_before, is_pair ? &all_after : nullptr, apart);
}

/// How many contacts there are at heads that are too near for bodies.
std::string near_line(const std::string& name, const ContactSums& sums) {
  const ContactLevel all = sums.all();
  std::string text = fmt::format("  {}: nearest heads of those who touch {} m;", name,
                                 number(sums.nearest_heads_m, 2));
  for (size_t i = 1; i < kNearHeads_m.size(); ++i)
    text += fmt::format(" {} of {} contacts while heads were nearer than {:.2f} m{}",
                        all.apart[0].contacts - all.apart[i].contacts, all.apart[0].contacts,
                        kNearHeads_m[i], i + 1 < kNearHeads_m.size() ? "," : "\n");
  return text;
}

std::string part_lines(const ContactSums& before, const ContactSums* after) {
  std::string text =
      fmt::format("\n  {:<18}{}{}{}\n", "parts, all levels", "  instants of depth, 90 %, most (cm)",
                  after == nullptr ? "" : "; then after", "");
  const auto half = [](const Histogram& depths) {
    return fmt::format("{:>9}{:>7}{:>7}", depths.count(), number(100 * depths.quantile(0.9), 1),
                       number(100 * depths.max(), 1));
  };
  for (size_t group = 0; group < kGroupPairs; ++group) {
    if (before.depths_of[group].count() == 0 &&
        (after == nullptr || after->depths_of[group].count() == 0))
      continue;
    text += fmt::format("  {:<18}{}{}\n", name_of_group_pair(group), half(before.depths_of[group]),
                        after == nullptr ? "" : "  >" + half(after->depths_of[group]));
  }
  return text;
}

}  // namespace

std::string contact_report(const AccountOf& before, const AccountOf* after, bool with_parts) {
  const ContactSums* const then = after == nullptr ? nullptr : &after->sums;
  std::string text =
      fmt::format("{}{}\n", before.name, after == nullptr ? "" : fmt::format(" > {}", after->name));
  text +=
      "  a person and minute: contacts, those with trunk in trunk, with a hand wholly in another "
      "part, with one deeper than it is thick; depth of two parts in cm; share of time in touch\n";
  text += block(before.sums, then, 0);
  for (size_t i = 1; i < kNearHeads_m.size(); ++i)
    text += fmt::format("  without those whose heads came nearer than {:.2f} m\n{}",
                        kNearHeads_m[i], block(before.sums, then, i));
  text += near_line(before.name, before.sums);
  if (after != nullptr) text += near_line(after->name, *then);
  return with_parts ? text + part_lines(before.sums, then) : text;
}

}  // namespace throng::realism
