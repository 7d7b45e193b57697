// Contact networks as files: lines "t i j" (SocioPatterns) and GraphML.
// Invariant: people are numbered by id; each pair appears once per second or graph, lower id first.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analysis/contacts/contact_statistics.h"
#include "base/files/anonymous_file.h"
#include "base/files/atomic_file.h"
#include "scenes/run/sink.h"

namespace throng {

/// Option that names the folder of all contact files.
inline constexpr std::string_view kContactsOption = "--contacts";

/// Writes a line "t i j" for each pair of people in contact within the second that ends at t.
class SecondsFile {
 public:
  SecondsFile(std::filesystem::path file, double step_s)
      : out_(std::move(file), kContactsOption), step_s_(step_s) {}

  /// Adds the pairs of a frame, as pair_key() in any order. Frames must come in order.
  void frame(int64_t number, std::span<const uint64_t> pairs);
  void end();

 private:
  void write_second();

  OutputFile out_;
  double step_s_;
  int64_t second_ = 0;  ///< second at whose end now_ is written
  std::vector<uint64_t> now_;
};

/// Writes an undirected graph of all people, edge by edge.
class GraphFile {
 public:
  /// Names and GraphML types (int, double, string) of the edge attributes.
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  GraphFile(std::filesystem::path file, const RunInfo& run, const Attributes& attributes);

  /// `values`: one per attribute, without characters that XML escapes.
  void edge(uint64_t pair, const std::vector<std::string>& values);
  void end();

 private:
  OutputFile out_;
  std::string text_;
};

/// Writes the contact network: touching.tij and touching.graphml.
class TouchingNetwork {
 public:
  TouchingNetwork(const std::filesystem::path& folder, const RunInfo& run);

  void frame(const Frame& frame);
  void ended(const Contact& contact);
  void end(const RunInfo& run);

 private:
  struct Spell {
    uint64_t pair = 0;
    double begin_s = 0, duration_s = 0;
  };
  struct SpellOrder {
    bool operator()(const Spell& a, const Spell& b) const {
      return std::pair(a.pair, a.begin_s) < std::pair(b.pair, b.begin_s);
    }
  };

  std::filesystem::path graph_;
  uint32_t people_;
  SecondsFile seconds_;
  ExternalSorter<Spell, SpellOrder> spells_;
  std::vector<uint64_t> pairs_;
};

}  // namespace throng
