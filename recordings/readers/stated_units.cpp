#include "recordings/readers/stated_units.h"

#include <fmt/format.h>

#include "base/errors.h"
#include "base/text.h"
#include "recordings/readers/column_name.h"

namespace throng {

bool StatedUnits::are_the_same(std::string_view a, std::string_view b) {
  const std::optional<Unit> first = unit_named(a), second = unit_named(b);
  if (!first || !second) return a == b;
  return first->quantity == second->quantity && first->in_si == second->in_si;
}

void StatedUnits::state(ColumnRole role, std::string_view unit, std::string_view source,
                        int64_t line) {
  if (unit.empty()) return;
  Stated& stated = stated_[static_cast<size_t>(role)];
  if (stated.unit.empty()) {
    stated = {std::string(unit), std::string(source), line, "", 0};
  } else if (stated.other.empty() && !are_the_same(stated.unit, unit)) {
    stated.other = unit;
    stated.other_line = line;
  }
}

void StatedUnits::state_all(std::string_view unit, std::string_view source, int64_t line) {
  const std::optional<Unit> found = unit_named(unit);
  switch (found ? found->quantity : Quantity::kLength) {
    case Quantity::kLength:
      for (const ColumnRole role : {ColumnRole::kX, ColumnRole::kY, ColumnRole::kZ})
        state(role, unit, source, line);
      break;
    case Quantity::kTime:
      state(ColumnRole::kTime, unit, source, line);
      break;
    case Quantity::kAngle:
      state(ColumnRole::kHeading, unit, source, line);
      break;
    case Quantity::kSpeed:
      break;
  }
}

void StatedUnits::state(const TableColumns& columns, const std::vector<std::string>& names,
                        int64_t line) {
  for (size_t role = 0; role < kColumnRoles; ++role) {
    if (columns.units[role].empty() && columns.remarks[role].empty()) continue;
    const std::string source = "the column " + in_quotes(names[columns.at[role]]);
    state(static_cast<ColumnRole>(role), columns.units[role], source, line);
    remark(static_cast<ColumnRole>(role), columns.remarks[role], source);
  }
}

void StatedUnits::remark(ColumnRole role, std::string_view text, std::string_view source) {
  if (!text.empty()) remarks_[static_cast<size_t>(role)] = {std::string(text), std::string(source)};
}

void StatedUnits::state(const StatedUnits& others) {
  for (size_t role = 0; role < kColumnRoles; ++role) {
    const Stated& other = others.stated_[role];
    state(static_cast<ColumnRole>(role), other.unit, other.source, other.line);
    state(static_cast<ColumnRole>(role), other.other, other.source, other.other_line);
    remark(static_cast<ColumnRole>(role), others.remarks_[role].text, others.remarks_[role].source);
  }
}

bool StatedUnits::agrees_with(const StatedUnits& other) const {
  for (size_t role = 0; role < kColumnRoles; ++role) {
    const std::string &mine = stated_[role].unit, &its = other.stated_[role].unit;
    if (!mine.empty() && !its.empty() && !are_the_same(mine, its)) return false;
  }
  return true;
}

std::optional<double> StatedUnits::known(ColumnRole role, const RecordingBuilder& builder,
                                         std::string_view way_out) const {
  const Stated& stated = of(role);
  if (stated.unit.empty()) return std::nullopt;
  const Quantity quantity = *quantity_of(role);
  const std::optional<Unit> unit = unit_named(stated.unit);
  if (!unit || unit->in_si == 0 || unit->quantity != quantity)
    throw InputError(builder.where(stated.line),
                     fmt::format("a unit of {} ({}) in {}", name_of(quantity),
                                 fmt::join(unit_names_of(quantity), ", "), stated.source),
                     fmt::format("{}{}", in_quotes(stated.unit), way_out));
  if (!stated.other.empty())
    throw InputError(builder.where(stated.other_line),
                     fmt::format("{} for {}, stated by {}", unit->name,
                                 kColumnRoleNames[static_cast<size_t>(role)], stated.source),
                     fmt::format("{}{}", in_quotes(stated.other), way_out));
  return unit->in_si;
}

void StatedUnits::note_overruled(RecordingBuilder& builder, std::string_view option, double in_si,
                                 std::initializer_list<ColumnRole> roles) const {
  int64_t count = 0;
  const Stated* first = nullptr;
  for (const ColumnRole role : roles) {
    const Stated& stated = of(role);
    if (stated.unit.empty()) continue;
    const std::optional<Unit> unit = unit_named(stated.unit);
    if (unit && unit->quantity == quantity_of(role) && unit->in_si == in_si && stated.other.empty())
      continue;
    if (count++ == 0) first = &stated;
  }
  if (count > 0)
    builder.note(fmt::format("columns whose units {} overrides", option), count,
                 fmt::format("{} of {}", in_quotes(first->unit), first->source));
}

void StatedUnits::settle_lengths(RecordingBuilder& builder, ColumnScales& out) const {
  if (const std::optional<double> unit_m = builder.options().unit_m) {
    out.x = out.y = out.z = UnitScale(*unit_m);
    out.area_unit_m = *unit_m;
    out.has_lengths = true;
    note_overruled(builder, "--unit", *unit_m, {ColumnRole::kX, ColumnRole::kY, ColumnRole::kZ});
    return;
  }
  constexpr const char* kWayOut = "; --unit overrides the file";
  const std::optional<double> x = known(ColumnRole::kX, builder, kWayOut);
  const std::optional<double> y = known(ColumnRole::kY, builder, kWayOut);
  const std::optional<double> z = known(ColumnRole::kZ, builder, kWayOut);
  out.has_lengths = x || y;
  // One of two related columns may state the unit of both: "x/cm y".
  const double x_m = x ? *x : y.value_or(1);
  const double y_m = y ? *y : x_m;
  out.x = UnitScale(x_m);
  out.y = UnitScale(y_m);
  out.z = UnitScale(z.value_or(x_m));
  out.has_z = z || x_m == y_m;
  if (x_m == y_m) out.area_unit_m = x_m;
}

void StatedUnits::settle_heading(RecordingBuilder& builder, ColumnScales& out) const {
  if (const std::optional<double> unit_rad = builder.options().heading_unit_rad) {
    out.heading = UnitScale(*unit_rad);
    out.has_heading = true;
    note_overruled(builder, "--heading-unit", *unit_rad, {ColumnRole::kHeading});
    return;
  }
  const std::optional<double> heading =
      known(ColumnRole::kHeading, builder, "; --heading-unit overrides the file");
  out.heading = UnitScale(heading.value_or(1));
  out.has_heading = heading.has_value();
}

void StatedUnits::note_remarks(RecordingBuilder& builder) const {
  int64_t count = 0;
  std::string first;
  for (const Remark& remark : remarks_)
    if (!remark.text.empty() && count++ == 0)
      first = fmt::format("{} in {}", in_quotes(remark.text), remark.source);
  if (count > 0)
    builder.note("columns with words in brackets that are not units (treated as remarks)", count,
                 std::move(first));
}

ColumnScales StatedUnits::settle(RecordingBuilder& builder, bool reads_time) const {
  ColumnScales out;
  note_remarks(builder);
  settle_lengths(builder, out);
  settle_heading(builder, out);
  if (reads_time) {
    out.time = UnitScale(
        known(ColumnRole::kTime, builder, "; convert the times, for example to t [s]").value_or(1));
    return out;
  }
  const Stated& time = of(ColumnRole::kTime);
  const std::optional<Unit> unit = unit_named(time.unit);
  const bool is_known = unit && unit->in_si > 0 && unit->quantity == Quantity::kTime;
  if (is_known) out.time = UnitScale(unit->in_si);
  out.has_time = time.unit.empty() || (is_known && time.other.empty());
  return out;
}

void note_no_z(RecordingBuilder& builder) {
  builder.note("a column z without a unit (ignored)", 1, "x and y have different ones");
}

}  // namespace throng
