// The .tri reader reads every dialect as the same tetrahedron and reports every defect in one line.
#include "avatars/mesh/tri.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "base/errors.h"
#include "base/random.h"

namespace throng::tri_test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::filesystem::path kFixtures =
    std::filesystem::path(THRONG_SOURCE_DIR) / "tests/avatars/fixtures/tri";

constexpr const char* kTetrahedron =
    "4\n0 0 0\n1 0 0\n0 1 0\n0 0 1.5\n4\n0 2 1\n0 1 3\n1 2 3\n0 3 2\n";

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.5F}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return mesh;
}

std::string message_of(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "(was accepted)";
}

std::string rejection(std::string_view text) {
  return message_of([&] { parse_tri(text, "part.tri"); });
}

void expect_sound(const Mesh& mesh) {
  ASSERT_FALSE(mesh.vertices.empty());
  for (const Eigen::Vector3f& v : mesh.vertices) ASSERT_TRUE(v.allFinite());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    ASSERT_GE(t.minCoeff(), 0);
    ASSERT_LT(t.maxCoeff(), static_cast<int>(mesh.vertices.size()));
  }
}

/// A file in the test's temporary folder, removed afterwards.
struct TemporaryFile {
  explicit TemporaryFile(const std::string& name) : path(testing::TempDir() + name) {}
  ~TemporaryFile() { std::filesystem::remove(path); }
  std::filesystem::path path;
};

struct Dialect {
  const char* file;
  TriDialect is;
};

class TriDialects : public testing::TestWithParam<Dialect> {};

TEST_P(TriDialects, ReadAsTheSameTetrahedron) {
  const TriFile read = read_tri(kFixtures / GetParam().file);
  EXPECT_EQ(read.mesh.vertices, tetrahedron().vertices);
  EXPECT_EQ(read.mesh.triangles, tetrahedron().triangles);
  const TriDialect& is = GetParam().is;
  EXPECT_EQ(read.dialect.keyword, is.keyword);
  EXPECT_EQ(read.dialect.counts_on_one_line, is.counts_on_one_line);
  EXPECT_EQ(read.dialect.one_based, is.one_based);
  EXPECT_EQ(read.dialect.comments, is.comments);
  EXPECT_EQ(read.dialect.crlf, is.crlf);
  EXPECT_EQ(read.dialect.byte_order_mark, is.byte_order_mark);
  EXPECT_EQ(format_tri(read.mesh), kTetrahedron) << "every dialect is written as the same form";
}

INSTANTIATE_TEST_SUITE_P(
    Tri, TriDialects,
    testing::Values(Dialect{"counts_then_lists.tri", {}}, Dialect{"keyword.tri", {.keyword = true}},
                    Dialect{"keyword_counts.tri", {.keyword = true, .counts_on_one_line = true}},
                    Dialect{"one_line_counts.tri", {.counts_on_one_line = true}},
                    Dialect{"one_based.tri", {.one_based = true}},
                    Dialect{"comments.tri", {.comments = true}},
                    Dialect{"crlf.tri", {.crlf = true}}, Dialect{"scientific.tri", {}},
                    Dialect{"byte_order_mark.tri", {.byte_order_mark = true}},
                    Dialect{"everything.tri", {true, true, true, true, true, true}}),
    [](const auto& dialect) {
      const std::string name = dialect.param.file;
      return name.substr(0, name.find('.'));
    });

TEST(Tri, ReadsVerticesOnlyAsAPointCloud) {
  for (const char* text : {"2\n0 0 0\n1 2 3\n", "2\n0 0 0\n1 2 3", "2\n0 0 0\n1 2 3\n0\n",
                           "2 0\n0 0 0\n1 2 3\n", "TRI\n2\n0 0 0\n1 2 3\n"}) {
    const Mesh mesh = parse_tri(text, "cloud.tri").mesh;
    EXPECT_TRUE(mesh.is_point_cloud()) << text;
    EXPECT_EQ(mesh.vertices.size(), 2u) << text;
  }
}

TEST(Tri, ReadsOneBasedIndicesOnlyIfProven) {
  // Neither 0 nor 4 occurs: nothing proves 1-based indices, and the first vertex is merely unused.
  const TriFile unproven = parse_tri("4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1\n1 2 3\n", "a.tri");
  EXPECT_FALSE(unproven.dialect.one_based);
  EXPECT_EQ(unproven.mesh.triangles[0], Eigen::Vector3i(1, 2, 3));
  const TriFile proven = parse_tri("4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1\n2 3 4\n", "a.tri");
  EXPECT_TRUE(proven.dialect.one_based);
  EXPECT_EQ(proven.mesh.triangles[0], Eigen::Vector3i(1, 2, 3));
}

TEST(Tri, RejectsEveryDefectWithALocatedMessage) {
  const std::string three = "3\n0 0 0\n1 0 0\n0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> defects = {
      {"", "part.tri:1: expected the number of vertices, found the end of the file"},
      {"# nothing\n", "part.tri:1: expected the number of vertices, found the end of the file"},
      {"TRI\n", "part.tri:1: expected the number of vertices, found the end of the file"},
      {"0\n", "part.tri:1: expected the number of vertices to be at least 1, found 0"},
      {"0\n0\n", "part.tri:1: expected the number of vertices to be at least 1, found 0"},
      {"-3\n0 0 0\n", "part.tri:1: expected the number of vertices to be at least 1, found -3"},
      {"many\n", "part.tri:1: expected the number of vertices, found 'many'"},
      {"3.0\n", "part.tri:1: expected the number of vertices, found '3.0'"},
      {"2000000000\n0 0 0\n", "part.tri:1: expected the number of vertices to fit into the file"},
      {"99999999999999999999\n", "part.tri:1: expected the number of vertices, found '9999"},
      {"1 2 3\n", "part.tri:1: expected the number of vertices, alone or with"},
      {"3\n0 0 0\n1 0 0\n", "part.tri:3: expected 3 coordinates (vertex 3 of 3), found the end"},
      {"3\n0 0 0\n1 0\n0 1 0\n", "part.tri:3: expected 3 coordinates, found 2 words"},
      {"3\n0 0 0\n1 0 0 0\n0 1 0\n", "part.tri:3: expected 3 coordinates, found 4 words"},
      {"3\n0 0 0\n1 nan 0\n0 1 0\n",
       "part.tri:3: expected a coordinate within 1e+07 m, found 'nan'"},
      {"3\n0 0 0\n1 -inf 0\n0 1 0\n", "found '-inf'"},
      {"3\n0 0 0\n1 1e99 0\n0 1 0\n", "found '1e99'"},
      {"3\n0 0 0\n1 2e7 0\n0 1 0\n", "found '2e7'"},
      {"3\n0 0 0\n1 0x1 0\n0 1 0\n", "found '0x1'"},
      {"3\n0 0 0\n1 1.5abc 0\n0 1 0\n", "found '1.5abc'"},
      {three + "-1\n", "part.tri:5: expected the number of triangles to be at least 0, found -1"},
      {three + "5000000\n0 1 2\n", "part.tri:5: expected the number of triangles to fit"},
      {three + "2\n0 1 2\n\n", "expected 3 vertex indices (triangle 2 of 2), found the end"},
      {three + "1\n0 1\n", "part.tri:6: expected 3 vertex indices, found 2"},
      {three + "1\n0 1 2 0\n", "part.tri:6: expected 3 vertex indices, found 4"},
      {three + "1\n0 1 7\n", "part.tri:6: expected a vertex index from 0 to 2, found '7'"},
      {three + "1\n0 1 3\n", "part.tri:6: expected a vertex index from 0 to 2, found '3'"},
      {three + "1\n0 1 -1\n", "part.tri:6: expected a vertex index from 0 to 2, found '-1'"},
      {three + "1\n0 1 1.5\n", "part.tri:6: expected a vertex index, found '1.5'"},
      {three + "1\n0 1 2\n0 2 1\n", "part.tri:7: expected the end of the file, found '0'"},
      {three + "0 1 2\n", "part.tri:5: expected the number of triangles, or the end of the file"},
      {three + "hello\n", "part.tri:5: expected the number of triangles, found 'hello'"},
      {"3 0\n0 0 0\n1 0 0\n0 1 0\nrubbish\n",
       "part.tri:5: expected the end of the file, found 'rubbish'"},
      {"\x7f"
       "ELF\x02\x01",
       "part.tri:1: expected the number of vertices, found '\\x7fELF\\x02"},
      {std::string("3\n0 0 0\n1 \0 0\n", 14), "part.tri:3: expected text, found a NUL byte"},
  };
  for (const auto& [text, message] : defects) {
    const std::string found = rejection(text);
    EXPECT_THAT(found, HasSubstr(message)) << "text:\n" << text;
    EXPECT_THAT(found, StartsWith("part.tri:"));
    EXPECT_EQ(found.find('\n'), std::string::npos) << "one line, found:\n" << found;
  }
}

TEST(Tri, RejectsIrregularFiles) {
  EXPECT_THAT(message_of([] { read_tri("nowhere/part.tri"); }),
              testing::StrEq("nowhere/part.tri: expected a .tri file, found no such file"));
  EXPECT_THAT(message_of([] { read_tri(testing::TempDir()); }), HasSubstr("found a directory"));
  EXPECT_THAT(message_of([] { read_tri("/dev/zero"); }), HasSubstr("not a regular file"));
}

TEST(Tri, RejectsThreeGigabytesWithoutReadingThem) {
  const TemporaryFile huge("throng_huge.tri");
  std::ofstream(huge.path) << "3\n";
  std::filesystem::resize_file(huge.path, uintmax_t{3} << 30);  // sparse: occupies no disk space
  EXPECT_THAT(message_of([&] { read_tri(huge.path); }),
              HasSubstr("expected a .tri file of at most 512 MiB, found 3072 MiB"));
}

TEST(Tri, RoundTripsBitwise) {
  constexpr uint64_t kSeed = 20261121;
  Mesh mesh;
  for (uint64_t i = 0; i < 3000; ++i) {
    const auto draw = [&](uint32_t k) {
      const RandomKey key{kSeed, i, 0, Purpose::kBoxWorld};
      // All magnitudes of a float below the limit, both signs.
      const double magnitude = std::pow(10.0, random_uniform(key, -44, 6.9, k));
      return static_cast<float>(random_uniform(key, k + 10) < 0.5 ? -magnitude : magnitude);
    };
    mesh.vertices.emplace_back(draw(0), draw(1), draw(2));
    mesh.triangles.emplace_back(static_cast<int>(i), static_cast<int>(i * 7 % 3000), 0);
  }
  const std::string once = format_tri(mesh);
  const TriFile read = parse_tri(once, "once.tri");
  EXPECT_EQ(read.mesh.vertices, mesh.vertices) << "seed " << kSeed;
  EXPECT_EQ(read.mesh.triangles, mesh.triangles);
  EXPECT_TRUE(format_tri(read.mesh) == once) << "seed " << kSeed;
}

TEST(Tri, ReadsOrRejectsDamagedFiles) {
  constexpr uint64_t kSeed = 7;
  const std::string seeds[] = {
      kTetrahedron,
      "\xEF\xBB\xBFTRI 4 2 # x\r\n0 0 0\r\n1e0 0 0\r\n0 +1 0\r\n0 0 1\r\n1 2 3\r\n2 3 4\r\n"};
  const std::string alphabet("0123456789 .-+eE\n\r#/;TRIan\0\xEF\xFF", 29);
  int accepted = 0;
  constexpr int kRounds = 40000;
  for (int round = 0; round < kRounds; ++round) {
    const RandomKey key{kSeed, static_cast<uint64_t>(round), 0, Purpose::kBoxWorld};
    std::string text = seeds[random_bits(key, 0) % 2];
    const uint32_t edits = 1 + static_cast<uint32_t>(random_bits(key, 1) % 4);
    for (uint32_t e = 0; e < edits && !text.empty(); ++e) {
      const size_t at = random_bits(key, 10 + 4 * e) % text.size();
      const char c = alphabet[random_bits(key, 11 + 4 * e) % alphabet.size()];
      switch (random_bits(key, 12 + 4 * e) % 4) {
        case 0:
          text[at] = c;
          break;
        case 1:
          text.insert(at, 1, c);
          break;
        case 2:
          text.erase(at, 1 + random_bits(key, 13 + 4 * e) % 5);
          break;
        default:
          text.resize(at);
      }
    }
    try {
      const TriFile file = parse_tri(text, "fuzz.tri");
      ++accepted;
      expect_sound(file.mesh);
      EXPECT_EQ(format_tri(parse_tri(format_tri(file.mesh), "again.tri").mesh),
                format_tri(file.mesh));
    } catch (const InputError& error) {
      ASSERT_THAT(error.what(), StartsWith("fuzz.tri:")) << "seed " << kSeed << ", round " << round;
    }
    if (HasFatalFailure()) FAIL() << "seed " << kSeed << ", round " << round << ":\n" << text;
  }
  // Both outcomes occur; both halves of the check are exercised.
  EXPECT_GT(accepted, kRounds / 100);
  EXPECT_LT(accepted, kRounds * 3 / 4);
}

}  // namespace
}  // namespace throng::tri_test
