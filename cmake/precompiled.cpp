// Nothing: the headers of cmake/Targets.cmake are precompiled with it.
