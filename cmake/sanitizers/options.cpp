// What the sanitizers ask every program for before it starts; TSAN_OPTIONS and the like still have
// the last word. Linked into everything by cmake/Sanitizers.cmake.
// One rule: they are shared libraries, and find only what a program exports.
#pragma GCC visibility push(default)

extern "C" {

#ifdef __SANITIZE_THREAD__
// A test writes, by a thread, in a process of its own whose files may not grow.
const char* __tsan_default_options() {
  return "die_after_fork=0:suppressions=" THRONG_TSAN_SUPPRESSIONS;
}
#endif

#ifdef __SANITIZE_ADDRESS__
const char* __asan_default_options() {
  return "detect_stack_use_after_return=1:strict_string_checks=1";
}
const char* __ubsan_default_options() { return "print_stacktrace=1"; }
#endif

}  // extern "C"

#pragma GCC visibility pop
