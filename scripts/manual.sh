#!/usr/bin/env bash
# Makes manual pages for the command and its subcommands from --help: scripts/manual.sh THRONG FOLDER. Prints a
# note and makes none without help2man.
set -euo pipefail

throng=$1 folder=$2
rm -rf "$folder"
if ! command -v help2man >/dev/null; then
  echo "No manual: help2man is not installed (scripts/setup.sh package)" >&2
  exit 0
fi
mkdir -p "$folder"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LC_ALL=C TZ=UTC
# The pages must not depend on the date.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(stat -c %Y "$throng")}
export SOURCE_DATE_EPOCH

help=$("$throng" --help)
version=$("$throng" --version | awk '{print $2}')
# Subcommands and their summaries: two columns after "Subcommands:".
commands=$(sed -n '/^Subcommands:/,/^$/ s/^  \([a-z]*\)  *\(.*\)$/\1 \2/p' <<<"$help" |
  grep -v '^help ')

# help2man reads a program's --help in GNU's form.
page() { # NAME SUMMARY COMMAND...
  local name=$1 summary=$2
  # The first line is the summary, already under NAME.
  "${@:3}" | sed 1d >"$work/$name.help"
  printf '#!/bin/sh\ncat "$0.help"\n' >"$work/$name"
  chmod +x "$work/$name"
  {
    printf '[name]\n%s \\- %s\n' "$name" "$summary"
    printf '[see also]\n'
    if [ "$name" = throng ]; then
      sed 's/^\([a-z]*\) .*/\\fBthrong-\1\\fR(1),/; $ s/,$//' <<<"$commands"
    else
      printf '\\fBthrong\\fR(1)\n'
    fi
  } >"$work/$name.h2m"
  help2man --no-info --no-discard-stderr --section 1 --version-string "throng $version" \
    --manual "Throng" --source "throng $version" --include "$work/$name.h2m" \
    --output "$work/$name.1" "$work/$name"
  gzip -9n <"$work/$name.1" >"$folder/$name.1.gz"
}

page throng "$(head -n 1 <<<"$help")" "$throng" --help
while read -r command summary; do
  page "throng-$command" "$summary" "$throng" "$command" --help
done <<<"$commands"
