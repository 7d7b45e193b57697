#include "viewer/server/page.h"

// The assembler embeds the file: a C++ array of its size costs seconds of compilation. The symbols
// are global, because link-time optimisation may move their users into another object.
asm(R"(
  .globl throng_page_begin, throng_page_end
  .hidden throng_page_begin, throng_page_end
  .section .rodata
  .balign 16
throng_page_begin:
  .incbin ")" THRONG_PAGE_FILE R"("
throng_page_end:
  .byte 0
  .previous
)");

extern "C" {
extern const char throng_page_begin[];
extern const char throng_page_end[];
}

namespace throng {

std::string_view page_html() {
  return {throng_page_begin, static_cast<size_t>(throng_page_end - throng_page_begin)};
}

}  // namespace throng
