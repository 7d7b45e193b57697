// Nothing: cmake/precompiled.h is compiled with it.
