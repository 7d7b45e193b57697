// Tables of studies as SQLite databases.
// One rule: a database is made in memory, so that equal rows make equal bytes, and read in a
// process of its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace throng {

struct StudyTable;

std::vector<uint8_t> sqlite_bytes(const StudyTable& table);
/// Table `runs` as CSV. Throws InputError.
std::string csv_of_sqlite(const std::filesystem::path& file);

}  // namespace throng
