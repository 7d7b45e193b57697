// Empty: only its precompiled header matters.
