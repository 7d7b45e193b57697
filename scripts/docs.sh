#!/usr/bin/env bash
# Checks the counts, hashes and sizes in README.md and docs/ against the commands of
# tests/apps/figures.yaml: scripts/docs.sh [--update] [--nightly] [DOCUMENT...], for example
# `scripts/docs.sh --update culling`. --nightly adds commands that take up to a minute and the shown commands.
# --update writes the printed figures into the documents, and docs/reference, docs/gallery.md and the classes of
# scene keys in python/throng anew, to be reviewed and committed. Exit code 1 if a figure differs (with --update: if it
# could not be updated).
set -euo pipefail
cd "$(dirname "$0")/.."

filter=
for argument in "$@"; do
  case "$argument" in
    --update) export THRONG_DOCS_UPDATE=1 ;;
    --nightly) export THRONG_NIGHTLY=1 ;;
    -*) echo "scripts/docs.sh: expected --update, --nightly or a document, found '$argument'" >&2; exit 2 ;;
    *) filter=${filter:+$filter:}*/$(basename "$argument" .md) ;;
  esac
done
bash scripts/build.sh release docs_tests throng no_miss gait_tests scenes_tests fuzz_replay custom_volume custom_engine
if [ -n "${THRONG_DOCS_UPDATE:-}" ]; then
  build/release/throng scenes --schema >scenes/scene.schema.json
  python3 scripts/scene_classes.py >python/throng/_scene_keys.py
  python3 scripts/reference.py
  python3 tests/apps/stable_test.py . build/release --update
fi
build/release/docs_tests --gtest_filter='SceneKeys.*'
exec build/release/docs_tests --gtest_filter="${filter:-*Document*}"
