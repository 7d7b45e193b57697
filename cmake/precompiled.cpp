// Nothing: a header is precompiled with it.
