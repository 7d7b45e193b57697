#include "bench/workbench/workbench.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "avatars/avatars.h"
#include "base/console.h"
#include "base/cores.h"
#include "base/errors.h"
#include "base/figure.h"
#include "base/files/atomic_file.h"
#include "base/text.h"

namespace throng {
namespace {

using bench::FalsePositives;
using bench::NoMissResult;
using bench::PartCell;

constexpr double kDensitiesPerM2[] = {1, 4};
constexpr size_t kWorstPairs = 10;  // maximum number of listed pairs of parts

double ratio(uint64_t a, uint64_t b) {
  return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0;
}

NoMissResult sum_of(const std::vector<NoMissResult>& rows) {
  NoMissResult sum{.family = "all"};
  for (const NoMissResult& row : rows) sum.add(row);
  return sum;
}

void put_no_miss(std::string& out, const std::vector<NoMissResult>& rows) {
  append(out, "  {:<10}{:>12}{:>12}{:>12}{:>8}\n", "family", "near pairs", "touching", "reported",
         "missed");
  const auto put = [&](const NoMissResult& row) {
    append(out, "  {:<10}{:>12}{:>12}{:>12}{:>8}\n", row.family, row.tested, row.touching,
           row.reported, row.missed);
  };
  for (const NoMissResult& row : rows) put(row);
  const NoMissResult sum = sum_of(rows);
  put(sum);
  if (sum.first_miss) append(out, "\n  first miss: {}\n", sum.first_miss->where);
  if (sum.differing > 0)
    append(out, "\n  the kernel differs from the scalar test: {} pairs\n", sum.differing);
}

void put_false_positives(std::string& out, const std::vector<FalsePositives>& counted) {
  append(out, "\nReported pairs of parts per touching pair, people walking\n  {:<18}", "volume");
  for (const double density : kDensitiesPerM2) append(out, "{:>12}", fmt::format("{}/m2", density));
  out += "\n";
  for (size_t v = 0; v < counted.front().volumes.size(); ++v) {
    append(out, "  {:<18}", counted.front().volumes[v].name);
    for (const FalsePositives& each : counted)
      append(out, "{:>12.3f}", ratio(each.volumes[v].reported, each.touching));
    out += "\n";
  }
  const FalsePositives& dense = counted.back();
  std::vector<std::pair<size_t, size_t>> cells;
  for (size_t a = 0; a < dense.parts.size(); ++a)
    for (size_t b = a; b < dense.parts.size(); ++b) cells.emplace_back(a, b);
  const auto wrong = [&](const auto& at) {
    const PartCell& cell = dense.cell(at.first, at.second);
    return cell.passed - cell.touching;
  };
  std::stable_sort(cells.begin(), cells.end(),
                   [&](const auto& p, const auto& q) { return wrong(p) > wrong(q); });
  cells.resize(std::min(cells.size(), kWorstPairs));
  append(out, "\nMost frequent errors of {}, {} per m2\n  {:<34}{:>9}{:>9}{:>10}\n",
         dense.matrix_volume, kDensitiesPerM2[1], "parts", "tests", "passed", "touching");
  for (const auto& at : cells) {
    const PartCell& cell = dense.cell(at.first, at.second);
    append(out, "  {:<34}{:>9}{:>9}{:>10}\n",
           fmt::format("{}, {}", dense.parts[at.first], dense.parts[at.second]), cell.tests,
           cell.passed, cell.touching);
  }
}

void put_costs(std::string& out, const WorkbenchResult& result) {
  append(out,
         "\nFig. 3 of the paper: 15 objects in a box, {} frames\n  {:<18}{:>10}{:>11}{:>9}"
         "{:>12}{:>12}\n",
         result.options.frames, "volume", "fit us", "update ns", "test ns", "ns / frame",
         "found, true");
  auto rows = result.figure_3;
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& p, const auto& q) { return p.frame_ns < q.frame_ns; });
  for (const bench::CostAndAccuracy& row : rows)
    append(out, "{} {:<18}{:>10.1f}{:>11.1f}{:>9.1f}{:>12.0f}{:>11.1f}%\n",
           row.name == result.name ? '>' : ' ', row.name, row.fit_ns * 1e-3, row.update_ns,
           row.test_ns, row.frame_ns, 100 * row.true_share);
}

std::string part_pairs_csv(const WorkbenchResult& result) {
  std::string csv = "per_m2,part_a,part_b,tests,passed,touching,false_positives\n";
  for (size_t i = 0; i < result.false_positives.size(); ++i) {
    const FalsePositives& counted = result.false_positives[i];
    for (size_t a = 0; a < counted.parts.size(); ++a)
      for (size_t b = a; b < counted.parts.size(); ++b) {
        const PartCell& cell = counted.cell(a, b);
        append(csv, "{},{},{},{},{},{},{}\n", kDensitiesPerM2[i], counted.parts[a],
               counted.parts[b], cell.tests, cell.passed, cell.touching,
               cell.passed - cell.touching);
      }
  }
  return csv;
}

void write_files(const WorkbenchResult& result) {
  const std::filesystem::path folder = result.options.out;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  write_file_atomically(folder / "part_pairs.csv", part_pairs_csv(result));
  if (const auto miss = sum_of(result.no_miss).first_miss)
    write_file_atomically(folder / "miss.txt", bench::to_text(*miss));
  if (!has_gnuplot()) return print_message("note: no figure_03.svg; install gnuplot\n");
  std::vector<bench::LabelledPoint> points;
  for (const bench::CostAndAccuracy& row : result.figure_3)
    points.push_back({row.name, row.frame_ns, row.true_share});
  draw({"figure_03", "", "", bench::figure_3_script(points, "15 updates, 105 tests", result.name)},
       folder);
}

/// Returns false unless `text` is a whole number above zero.
bool read_number(const char* text, uint64_t& out) {
  const char* const end = text + std::strlen(text);
  const auto [at, error] = std::from_chars(text, end, out);
  return error == std::errc() && at == end && out > 0;
}

WorkbenchOptions options_of(int argc, char** argv) {
  WorkbenchOptions options;
  options.threads = core_count();
  const char* const usage = "[PAIRS [SEED [FOLDER]]]";
  for (int i = 1; i < std::min(argc, 3); ++i)
    if (!read_number(argv[i], i == 1 ? options.no_miss_pairs : options.seed))
      throw InputError(argv[0], fmt::format("{}, whole numbers from 1", usage),
                       fmt::format("'{}'", argv[i]));
  if (argc > 3) options.out = argv[3];
  return options;
}

}  // namespace

uint64_t WorkbenchResult::missed() const {
  uint64_t sum = sum_of(no_miss).missed;
  for (const FalsePositives& each : false_positives)
    for (const bench::VolumeReport& volume : each.volumes)
      if (volume.name == name) sum += volume.missed;
  return sum;
}

bool WorkbenchResult::has_no_misses() const {
  return missed() == 0 && sum_of(no_miss).differing == 0;
}

WorkbenchResult try_volume(const bench::TestedVolume& volume, const WorkbenchOptions& options) {
  WorkbenchResult result{volume.name(), options, {}, {}, {}};
  Workers workers(options.threads);
  result.no_miss = bench::check_no_misses(volume, options.no_miss_pairs, options.seed, workers);

  const bench::VolumeList project = bench::project_volumes();
  std::vector<const bench::TestedVolume*> volumes(project.begin(), project.end());
  volumes.push_back(&volume);
  const auto adult = load_model(adult_urdf());
  for (const double per_m2 : kDensitiesPerM2) {
    bench::Crowd crowd(adult, {.avatars = options.walkers, .per_m2 = per_m2, .seed = options.seed});
    result.false_positives.push_back(bench::count_false_positives(
        crowd, volumes, {.frames = 4, .stride = 20, .matrix_volume = volume.name()},
        [](const std::string&) {}));
  }
  result.figure_3 =
      bench::measure_figure_3(paper::load_objects(), volumes, options.frames, options.seed);
  return result;
}

std::string to_text(const WorkbenchResult& result) {
  std::string out;
  append(out, "{}: {} of {} touching pairs missed, seed {}\n\n", result.name, result.missed(),
         sum_of(result.no_miss).touching + result.false_positives[0].touching +
             result.false_positives[1].touching,
         result.options.seed);
  put_no_miss(out, result.no_miss);
  put_false_positives(out, result.false_positives);
  put_costs(out, result);
  return out;
}

int workbench_main(const bench::TestedVolume& volume, int argc, char** argv) {
  try {
    const WorkbenchOptions options = options_of(argc, argv);
    const WorkbenchResult result = try_volume(volume, options);
    print_result_text(to_text(result));
    if (const auto miss = sum_of(result.no_miss).first_miss; miss && options.out.empty())
      print_result("\n{}", bench::to_text(*miss));
    if (!options.out.empty()) write_files(result);
    return result.has_no_misses() ? 0 : 1;
  } catch (const InputError& error) {
    print_message("{}\n", error.what());
    return 2;
  } catch (const EnvironmentError& error) {
    print_message("{}\n", error.what());
    return 3;
  }
}

}  // namespace throng
