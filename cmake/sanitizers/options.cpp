// Default options of the sanitizers, linked into every program by cmake/Sanitizers.cmake;
// TSAN_OPTIONS and the like override them.
// Invariant: they are exported, because sanitizers are shared libraries and find exported names
// only.
#pragma GCC visibility push(default)

extern "C" {

#ifdef __SANITIZE_THREAD__
// A test writes from a thread of a forked process with a file size limit.
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
