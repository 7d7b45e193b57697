// Who was with whom as files of networks: lines "t i j", as SocioPatterns has them, and GraphML.
// One rule: people are numbered by their ids, and every two of them stand once in a second or a
// graph, the lower first.
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

/// The option that names the folder of all files of contacts.
inline constexpr std::string_view kContactsOption = "--contacts";

/// A line "t i j" for each two people who were together within the second that ends at t.
class SecondsFile {
 public:
  SecondsFile(std::filesystem::path file, double step_s)
      : out_(std::move(file), kContactsOption), step_s_(step_s) {}

  /// Those together in a frame, by pair_key(), in any order; frames come one after another.
  void frame(int64_t number, std::span<const uint64_t> pairs);
  void end();

 private:
  void write_second();

  OutputFile out_;
  double step_s_;
  int64_t second_ = 0;  ///< at whose end those of now_ are written
  std::vector<uint64_t> now_;
};

/// An undirected graph of all people, edge by edge.
class GraphFile {
 public:
  /// Names of attributes of edges and their types in GraphML: int, double, string.
  using Attributes = std::vector<std::pair<std::string, std::string>>;

  GraphFile(std::filesystem::path file, const RunInfo& run, const Attributes& attributes);

  /// `values`, one an attribute, need no escapes.
  void edge(uint64_t pair, const std::vector<std::string>& values);
  void end();

 private:
  OutputFile out_;
  std::string text_;
};

/// Who touched whom: touching.tij and touching.graphml.
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
