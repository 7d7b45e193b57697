#include "analysis/contacts/contact_sink.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "base/append.h"
#include "base/csv.h"
#include "base/files/whole_file.h"
#include "base/text.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTables[] = {
    "contacts.csv", "pairs.csv",   "people.csv",        "minutes.csv",  "durations.csv",
    "parts.csv",    "density.csv", "parts_seconds.csv", "touching.tij", "touching.graphml"};
constexpr const char* kBodyFigure = "contact_body";
constexpr const char* kFigures[] = {"contact_rates", "contact_durations", "contact_parts",
                                    "contact_density"};

std::string people_csv(const ContactStatistics& statistics, const RunInfo& run) {
  std::string text =
      "id,group,present_s,contacts,contacts_per_min,partners,touching_s,obstacle_contacts\n";
  for (size_t id = 0; id < statistics.people().size(); ++id) {
    const PersonContacts& person = statistics.people()[id];
    const double rate = person.present_s > 0 ? 60 * person.contacts / person.present_s : 0;
    const std::string group =
        id < run.group_of_avatar.size() ? run.groups[run.group_of_avatar[id]] : "";
    append(text, "{},{},{:.3f},{},{:.3f},{},{:.3f},{}\n", id, csv_quoted(group), person.present_s,
           person.contacts, rate, person.partners, person.touching_s, person.obstacle_contacts);
  }
  return text;
}

std::string minutes_csv(const ContactStatistics& statistics) {
  std::string text = "minute,contacts,person_s,contacts_per_person_min\n";
  for (size_t i = 0; i < statistics.minutes().size(); ++i) {
    const MinuteRow& row = statistics.minutes()[i];
    append(text, "{},{},{:.3f},{:.4f}\n", i, row.contacts, row.person_s,
           row.person_s > 0 ? 120 * static_cast<double>(row.contacts) / row.person_s : 0.0);
  }
  return text;
}

/// Upper ends in seconds; the last class has none.
constexpr double kDurations_s[] = {0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30};

std::vector<uint64_t> duration_counts(const ContactStatistics& statistics) {
  std::vector<uint64_t> counts(std::size(kDurations_s) + 1, 0);
  for (size_t frames = 0; frames < statistics.lengths().size(); ++frames) {
    const double duration_s = static_cast<double>(frames) * statistics.step_s();
    counts[static_cast<size_t>(
        std::lower_bound(std::begin(kDurations_s), std::end(kDurations_s), duration_s - 1e-6) -
        std::begin(kDurations_s))] += statistics.lengths()[frames];
  }
  return counts;
}

std::string durations_csv(const ContactStatistics& statistics) {
  std::string text = "above_s,up_to_s,contacts,share\n";
  const std::vector<uint64_t> counts = duration_counts(statistics);
  const double all = std::max<double>(1, static_cast<double>(statistics.whole_count()));
  for (size_t i = 0; i < counts.size(); ++i)
    append(text, "{},{},{},{:.5f}\n", i == 0 ? 0 : kDurations_s[i - 1],
           i < std::size(kDurations_s) ? fmt::format("{}", kDurations_s[i]) : "", counts[i],
           static_cast<double>(counts[i]) / all);
  append(text, "cut,,{},\n", statistics.cut_count());
  return text;
}

template <typename Value>
std::string matrix_csv(const PartMatrix& parts, const std::vector<Value>& values,
                       const char* format, const std::vector<uint64_t>* obstacles) {
  std::string text = "part";
  for (const std::string& name : parts.names) text += fmt::format(",{}", csv_field(name));
  text += obstacles != nullptr ? ",obstacle\n" : "\n";
  for (size_t row = 0; row < parts.names.size(); ++row) {
    text += csv_field(parts.names[row]);
    for (size_t column = 0; column < parts.names.size(); ++column)
      text += fmt::format(fmt::runtime(format), values[row * parts.names.size() + column]);
    text += obstacles != nullptr ? fmt::format(",{}\n", (*obstacles)[row]) : "\n";
  }
  return text;
}

std::string density_csv(const ContactStatistics& statistics) {
  std::string text = "level,above_per_m2,up_to_per_m2,contacts,person_s,contacts_per_person_min\n";
  for (size_t i = 0; i < DensityLevels::kCount; ++i) {
    const DensityRow& row = statistics.densities()[i];
    append(text, "{},{},{},{},{:.1f},{:.4f}\n", DensityLevels::kNames[i],
           i == 0 ? 0 : DensityLevels::kBounds[i - 1],
           i < DensityLevels::kBounds.size() ? fmt::format("{}", DensityLevels::kBounds[i]) : "",
           row.contacts, row.person_s, row.per_person_min());
  }
  return text;
}

Figure rate_figure(const ContactStatistics& statistics) {
  std::vector<double> rates;  // at least one
  for (const PersonContacts& person : statistics.people())
    if (person.present_s > 0) rates.push_back(60 * person.contacts / person.present_s);
  const double most = *std::max_element(rates.begin(), rates.end());
  // At most 25 bars of a round width.
  double width = 0.1;
  for (int i = 0; most / width > 25; ++i) width *= i % 3 == 1 ? 2.5 : 2;
  std::vector<int> counts(static_cast<size_t>(most / width) + 1, 0);
  for (const double rate : rates) ++counts[static_cast<size_t>(rate / width)];
  std::string script = "$data << EOD\n";
  for (size_t i = 0; i < counts.size(); ++i)
    script += fmt::format("{} {}\n", (static_cast<double>(i) + 0.5) * width, counts[i]);
  script += fmt::format(
      "EOD\nset boxwidth {}\nset style fill solid 0.85\nset grid ytics\nunset key\nset yrange "
      "[0:*]\nset xrange [0:*]\nset xlabel 'contacts with others a minute'\nset ylabel 'people'\n"
      "plot $data with boxes linecolor rgb '{}'\n",
      0.9 * width, kFigureColours[0]);
  return {"contact_rates", "Contacts per person and minute", "", script};
}

Figure duration_figure(const ContactStatistics& statistics) {
  const std::vector<uint64_t> counts = duration_counts(statistics);
  const double all = std::max<double>(1, static_cast<double>(statistics.whole_count()));
  std::string script = "$data << EOD\n";
  for (size_t i = 0; i < counts.size(); ++i)
    script += fmt::format(
        "\"{}\" {}\n",
        i < std::size(kDurations_s) ? fmt::format("up to {}", kDurations_s[i]) : "longer",
        100 * static_cast<double>(counts[i]) / all);
  script += fmt::format(
      "EOD\nset boxwidth 0.9\nset style fill solid 0.85\nset grid ytics\nunset key\nset yrange "
      "[0:*]\nset xlabel 'length of a contact, s'\nset ylabel 'share of contacts, %'\nplot $data "
      "using 0:2:xtic(1) with boxes linecolor rgb '{}'\n",
      kFigureColours[0]);
  return {"contact_durations", "How long contacts last", "", script};
}

Figure part_figure(const ContactStatistics& statistics) {
  const PartMatrix parts = statistics.parts();
  // Equal cells, so that a rare pair is seen beside a frequent one: the colours are logarithmic.
  const HeatMap map{.names = spoken(parts.names),
                    .values = {parts.counts.begin(), parts.counts.end()},
                    .using_expression = "(log10(1 + $3))",
                    .label = "contacts, log_1_0(1 + n)"};
  return {"contact_parts", "Which body parts touch which", "", script_of(map)};
}

Figure density_figure(const ContactStatistics& statistics) {
  std::string script = "$data << EOD\n";
  for (size_t i = 0; i < DensityLevels::kCount; ++i) {
    const DensityRow& row = statistics.densities()[i];
    if (row.person_s == 0) continue;
    const std::string range =
        i + 1 < DensityLevels::kCount
            ? fmt::format("{} to {}", i == 0 ? 0 : DensityLevels::kBounds[i - 1],
                          DensityLevels::kBounds[i])
            : fmt::format("above {}", DensityLevels::kBounds.back());
    script +=
        fmt::format("\"{}\\n{}\" {}\n", DensityLevels::kNames[i], range, row.per_person_min());
  }
  script += fmt::format(
      "EOD\nset boxwidth 0.7\nset style fill solid 0.85\nset grid ytics\nunset key\nset yrange "
      "[0:*]\nset xlabel 'people per m^2 around them' offset 0,-1\nset ylabel 'contacts a person "
      "and "
      "minute'\nset bmargin 5\nplot $data using 0:2:xtic(1) with boxes linecolor rgb '{}'\n",
      kFigureColours[0]);
  return {"contact_density", "Contacts by density", "", script};
}

}  // namespace

std::vector<Figure> figures_of(const ContactStatistics& statistics) {
  const ContactTotals totals = statistics.totals();
  std::vector<Figure> figures;
  if (totals.person_s > 0) figures.push_back(rate_figure(statistics));
  if (statistics.whole_count() > 0) figures.push_back(duration_figure(statistics));
  // A single cell is no picture, and one colour no scale.
  if (totals.contacts > 0 && statistics.parts().names.size() > 1)
    figures.push_back(part_figure(statistics));
  if (totals.contacts > 0) figures.push_back(density_figure(statistics));
  return figures;
}

std::vector<std::string> contact_files() {
  std::vector<std::string> names(std::begin(kTables), std::end(kTables));
  for (const std::string& name : near_table_files()) names.push_back(name);
  for (const char* figure : kFigures) names.push_back(fmt::format("{}.svg", figure));
  names.push_back(fmt::format("{}.svg", kBodyFigure));
  return names;
}

ContactSink::ContactSink(fs::path folder, bool with_points)
    : folder_(std::move(folder)), with_points_(with_points) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw cannot_write(folder_, error.value(), kContactsOption);
}

void ContactSink::begin(const RunInfo& run) {
  contacts_ = std::make_unique<FolderFile>(folder_ / "contacts.csv", kContactsOption);
  statistics_ = std::make_unique<ContactStatistics>(run);
  touching_ = std::make_unique<TouchingNetwork>(folder_, run);
  near_ = std::make_unique<NearTables>(folder_, run);
  body_map_ = with_points_ ? std::make_unique<BodyMap>(run) : nullptr;
  notes_.clear();
  contacts_->write(
      "begin_s,duration_s,person_a,person_b,x_m,y_m,density_per_m2,first_part_a,first_part_b,"
      "part_contacts,cut\n");
}

void ContactSink::list_ended() {
  for (const Contact& contact : statistics_->ended()) touching_->ended(contact);
  for (const Contact& contact : statistics_->ended())
    contacts_->write(fmt::format("{:.4f},{:.4f},{},{},{:.3f},{:.3f},{:.3f},{},{},{},{}\n",
                                 contact.begin_s, contact.duration_s, contact.a, contact.b,
                                 contact.place_m.x(), contact.place_m.y(), contact.density_per_m2,
                                 csv_field(statistics_->part_name(contact.a, contact.first_part_a)),
                                 csv_field(statistics_->part_name(contact.b, contact.first_part_b)),
                                 contact.part_contacts, contact.cut ? 1 : 0));
}

void ContactSink::frame(const RunInfo& run, const Frame& frame) {
  statistics_->frame(frame);
  list_ended();
  touching_->frame(frame);
  near_->frame(run, frame);
  if (body_map_ != nullptr) body_map_->frame(run, frame);
}

void ContactSink::end(const RunInfo& run, const RunEnd& end) {
  statistics_->end(end);
  list_ended();
  contacts_->close();
  touching_->end(run);
  near_->end(run);
  if (!near_->note().empty()) notes_.push_back(near_->note());
  write_pairs();
  const PartMatrix parts = statistics_->parts();
  const auto write_file = [](const fs::path& file, const std::string& text) {
    write_whole_file(file, text, {.what = "the contacts"});
  };
  write_file(folder_ / "people.csv", people_csv(*statistics_, run));
  write_file(folder_ / "minutes.csv", minutes_csv(*statistics_));
  write_file(folder_ / "durations.csv", durations_csv(*statistics_));
  write_file(folder_ / "parts.csv", matrix_csv(parts, parts.counts, ",{}", &parts.obstacle_counts));
  write_file(folder_ / "parts_seconds.csv", matrix_csv(parts, parts.seconds, ",{:.3f}", nullptr));
  write_file(folder_ / "density.csv", density_csv(*statistics_));
  draw_figures();
}

void ContactSink::write_pairs() const {
  const double step_s = statistics_->step_s();
  FolderFile out(folder_ / "pairs.csv", kContactsOption);
  out.write("begin_s,duration_s,person_a,part_a,person_b,part_b,cut\n");
  statistics_->for_each_part_contact([&](const PartContact& contact) {
    const PairKey pair = contact.pair;
    out.write(fmt::format(
        "{:.4f},{:.4f},{},{},{},{},{}\n", static_cast<double>(contact.begin_frame) * step_s,
        static_cast<double>(contact.frames) * step_s, pair.a(),
        csv_field(statistics_->part_name(pair.a(), pair.part_a())), pair.b(),
        csv_field(statistics_->part_name(pair.b(), pair.part_b())), contact.cut ? 1 : 0));
  });
  out.close();
}

void ContactSink::draw_figures() {
  // Figures of an earlier run beside the numbers of this one would be wrong.
  std::error_code error;
  for (const char* name : kFigures) fs::remove(folder_ / fmt::format("{}.svg", name), error);
  fs::remove(folder_ / fmt::format("{}.svg", kBodyFigure), error);
  if (!has_gnuplot()) {
    notes_.push_back(fmt::format("no figures in {}: gnuplot is not installed", folder_.string()));
    return;
  }
  std::vector<std::string> missing(std::begin(kFigures), std::end(kFigures));
  for (const Figure& figure : figures_of(*statistics_)) {
    draw(figure, folder_);
    std::erase(missing, figure.id);
  }
  if (body_map_ != nullptr && body_map_->has_figure()) draw(body_map_->figure(), folder_);
  if (body_map_ != nullptr && !body_map_->has_figure()) missing.emplace_back(kBodyFigure);
  if (!missing.empty())
    notes_.push_back(fmt::format("no {}.svg in {}: there was nothing to draw",
                                 fmt::join(missing, ".svg, "), folder_.string()));
}

}  // namespace throng
