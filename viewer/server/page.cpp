#include "viewer/server/page.h"

// The assembler takes the file as it is: a C++ array of its size costs seconds of compilation. Its
// names are global, because optimisation at link time may put what uses them into another object.
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
