// Text that comes from files and command lines: what may stand in a name, and how to show the rest.
// One rule: nothing here throws; bytes that are no UTF-8, and what commands a terminal, never pass.
#pragma once

#include <string>
#include <string_view>

namespace throng {

/// The bytes of the character that `text` begins with, if it is UTF-8 (RFC 3629: no surrogates, the
/// shortest form) and no control character (C0, DEL, C1); otherwise 0.
size_t printable_character(std::string_view text);

/// The first byte that is no UTF-8 (control characters are), or npos.
size_t find_no_utf8(std::string_view text);

/// Why a text is no name, in words that follow "found", or "": names are 1 to kMaxNameBytes bytes
/// of printable UTF-8, not all blank.
std::string defect_of_name(std::string_view name);

/// The same text with "\xNN" for each byte of what is not printable: fit for JSON, a table and a
/// name.
std::string escaped(std::string_view text);

/// The beginning of a text for an error, which is one line whatever a file holds: 'escaped...'.
std::string in_quotes(std::string_view text);

/// Without the blanks at both ends.
std::string_view without_blanks_around(std::string_view text);

/// A name after a file whose name may be anything: escaped(), and cut where it is too long.
std::string name_after(std::string_view file_stem);

}  // namespace throng
