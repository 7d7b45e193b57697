#include "bench/paper/report.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "base/errors.h"
#include "base/files/whole_file.h"
#include "bench/paper/figures.h"
#include "bench/paper/pictures.h"
#include "bench/paper/tables.h"

namespace throng::paper {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStyle =
    "body{font:16px/1.5 sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;font-size:13px;display:block;overflow-x:auto;margin:.5em 0 2em}"
    "td,th{border:1px solid #ccc;padding:2px 7px;text-align:right;white-space:nowrap}"
    "td:first-child,th:first-child{text-align:left}th{background:#f0f0f0}"
    "figure{margin:2em 0}figcaption{font-size:14px;color:#555}img,svg{max-width:100%;height:auto}";

/// Above, something else ran on the machine.
constexpr double kQuiet = 1.25;

constexpr const char* kIntroduction =
    "Every experiment of Suaib, Bade, Mohamad: Hybrid Collision Culling by Bounding Volumes "
    "Manipulation in Massive Rigid Body Simulation, TELKOMNIKA 11(6), 2013, run again on the {} "
    "parts of {}, with the paper's numbers beside. docs/paper.md lists what had to be "
    "guessed and why numbers differ.";

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t group = 0;
    for (size_t j = 0; j < 3; ++j)
      group = group << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (size_t j = 0; j < 4; ++j)
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18 - 6 * j) & 63];
  }
  return text;
}

std::string how(const PaperResult& result, const std::string& cpu) {
  return fmt::format(
      "{} frames, seed {}, {} seed(s), a box of {} m; {}, {}. The paper: Core 2 Duo E7400, 2 GB, "
      "Windows XP. Noise: the slowest tenth of a strategy's runs took {:.2f} times as long as the "
      "fastest tenth (median over strategies and sizes; {}).",
      result.options.frames, result.options.seed, result.options.seeds, result.edge_m, cpu,
      name_of(resolved(SimdTarget::kBest)), result.noise(),
      result.noise() < kQuiet ? "a quiet machine" : "a busy machine: read counts, not times");
}

/// What stands where: figures and pictures first, by number as in the paper, then the tables.
struct Pages {
  std::string html, markdown;

  void add_figure(const std::string& title, const std::string& caption, const std::string& inlined,
                  const std::string& file) {
    html += "<figure>" + inlined + "<figcaption><b>" + html_escaped(title) + "</b> " +
            html_escaped(caption) + "</figcaption></figure>\n";
    markdown += fmt::format("![{}]({})\n\n*{}* {}\n\n", title, file, title, caption);
  }
  void add_table(const Table& table) {
    html += to_html(table);
    markdown += to_markdown(table);
  }
};

}  // namespace

void write_report(const PaperResult& result, const std::vector<Object>& objects,
                  const std::string& cpu, const fs::path& folder) {
  Pages pages;
  const std::string model = result.options.model.empty()
                                ? "Throng's adult"
                                : fs::path(result.options.model).filename().string();
  const std::string introduction = fmt::format(kIntroduction, objects.size(), model);
  const std::string title = "The paper, reproduced";
  pages.html = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + title +
               "</title><style>" + kStyle + "</style></head><body>\n<h1>" + title + "</h1>\n<p>" +
               html_escaped(introduction) + "</p>\n<p>" + html_escaped(how(result, cpu)) + "</p>\n";
  pages.markdown = "# " + title + "\n\n" + introduction + "\n\n" + how(result, cpu) + "\n\n";
  const std::vector<Picture> pictures = pictures_of(objects, result.options.seed);
  auto picture = pictures.begin();
  const auto add_pictures_before = [&](const std::string& id) {
    for (; picture != pictures.end() && (id.empty() || picture->id < id); ++picture) {
      const std::string name = picture->id + ".png";
      write_png(folder / name, picture->image);
      pages.add_figure(
          picture->title, picture->caption,
          "<img alt=\"\" src=\"data:image/png;base64," + base64(read_file(folder / name)) + "\">",
          name);
    }
  };
  for (const Figure& figure : figures_of(result)) {
    add_pictures_before(figure.id.starts_with("figure") ? figure.id : "");
    std::string svg = draw(figure, folder);
    svg.erase(0, svg.find("<svg"));
    pages.add_figure(figure.title, figure.caption, svg, figure.id + ".svg");
  }
  for (const Table& table : tables_of(result)) pages.add_table(table);
  write_whole_file(folder / "report.html", pages.html + "</body></html>\n");
  write_whole_file(folder / "report.md", pages.markdown);
}

}  // namespace throng::paper
