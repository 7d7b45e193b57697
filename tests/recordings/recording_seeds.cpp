#include "tests/recordings/recording_seeds.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/recordings/binary_files.h"

namespace throng {
namespace {

namespace fs = std::filesystem;

std::string packed(const std::string& text) {
  std::string out(text.size() + 1000, '\0');
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, MAX_WBITS + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

template <typename Make>
std::string made(const Make& make) {
  const fs::path file = fs::temp_directory_path() / fmt::format("recording_seed_{}", getpid());
  make(file);
  std::ifstream in(file, std::ios::binary);
  std::string out(std::istreambuf_iterator<char>(in), {});
  fs::remove(file);
  return out;
}

template <typename Line>
std::string lines(const Line& line) {
  std::string out;
  for (int frame = 0; frame < 6; ++frame)
    for (int id = 0; id < 3; ++id) out += line(frame, id, 0.05 * frame + id, 2.0 * id);
  return out;
}

}  // namespace

std::vector<std::string> recording_seeds() {
  std::vector<std::string> out;
  out.push_back("# framerate: 25.00 fps\n# id frame x/cm y/cm z/cm\n" +
                lines([](int frame, int id, double x, double y) {
                  return fmt::format("{} {} {} {} {}\n", id, frame + 7, 100 * x, 100 * y, 170 + id);
                }));
  out.push_back(lines([](int frame, int id, double x, double y) {
    return fmt::format("{}\t{}\t{}\t{}\n", id, frame, 100 * x, 100 * y);
  }));
  out.push_back(lines([](int frame, int id, double x, double y) {
    return fmt::format("{}.0 {}.0 {} {}\n", 780 + 10 * frame, id, x, y);
  }));
  out.push_back("time,pedID,posX,posY\n" + lines([](int frame, int id, double x, double y) {
                  return fmt::format("{:.2f},{},{},{}\n", 0.5 * frame, id, x, y);
                }));
  out.push_back(packed(out.back()));
  out.push_back(
      "\"t\",\"id\",\"name\",\"active\",\"x\",\"y\",\"z\"\n\"s\",\"\",\"\",\"\",\"m\","
      "\"m\",\"m\"\n" +
      lines([](int frame, int id, double x, double y) {
        return fmt::format("{},{},\"p, {}\",{},{},{},0.02\n", frame, id, id, frame % 5, x, y);
      }));
  out.push_back("$VISION\n* File\n$PEDESTRIAN:NO;SIMSEC;COORDCENTX;COORDCENTY\n" +
                lines([](int frame, int id, double x, double y) {
                  return fmt::format("{};{:.1f};{};{}\n", id, 0.2 * frame, x, y);
                }));
  out.push_back("frame,time_s,id,x_m,y_m,heading_rad,speed_mps\n" +
                lines([](int frame, int id, double x, double y) {
                  return fmt::format("{},{:.4f},{},{:.4f},{:.4f},0.5,1\n", frame, frame / 60.0, id,
                                     x, y);
                }));
  out.push_back("id;frame;x/m;y/m\n" + lines([](int frame, int id, double x, double y) {
                  return fmt::format("{};{};{};{}\n", id, 10 * frame, x + 365'000, y + 5.6e6);
                }));
  out.push_back("pedestrianId simTime endTime-PID1 startX-PID1 startY-PID1 endX-PID1 endY-PID1\n" +
                lines([](int frame, int id, double x, double y) {
                  return fmt::format("{} {} {} {} {} {} {}\n", id, 0.4 * frame, 0.4 * frame + 0.4,
                                     x, y, x + 0.05, y);
                }));
  out.push_back("#framerate: 29,97 fps\n#X,Y,Z: positions (in metres)\n#ID\tFR\tX\tY\tZ\n" +
                lines([](int frame, int id, double x, double y) {
                  return frame == 3 ? fmt::format("{}\t{}\t\t?\t1.7\n", id, frame)
                                    : fmt::format("{}\t{}\t{}\t{}\t1.7\n", id, frame, x, y);
                }));
  out.push_back("id t (ms) x in cm y [ft] heading_deg\n" +
                lines([](int frame, int id, double x, double y) {
                  return fmt::format("{} {} {} {} 90\n", id, 40 * frame, 100 * x, y / 0.3048);
                }));
  out.push_back(made([](const fs::path& file) { make_sqlite(file, jupedsim_2()); }));
  out.push_back(made([](const fs::path& file) { make_hdf5(file, {}); }));
  return out;
}

}  // namespace throng
