#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# clang-tidy by .clang-tidy, over what the preset `release` builds; its generated headers must be there. The matchers read
# each folder as one text, as it is compiled. The path-sensitive analyzer goes file by file, which takes it less time, but
# still as long as half of all other checks: without --all it reads only what reads foreign files.
# usage: tools/lint.sh [--all]
set -u
cd "$(dirname "$0")/.." || exit 1
case ${1-} in
  "") analyzed="parametrize/src/import solver/asset solver/src/scene/scene.cpp solver/src/scene/json_reader.cpp
    tools/export/cache_reader.cpp" ;;
  --all) analyzed="parametrize solver tools meshes" ;;
  *) echo "usage: tools/lint.sh [--all]" >&2; exit 2 ;;
esac

# tidy FOLDER CHECKS SOURCES: with the compile commands of a folder, which are GCC's and name options that clang does not
# know. Fails where there is nothing to check.
tidy() {
  if [ -z "$3" ]; then
    echo "lint.sh: no sources found by $1/compile_commands.json; build the preset release first" >&2
    return 1
  fi
  printf '%s\n' "$3" | xargs -n 1 -P "$(nproc)" clang-tidy --quiet --config-file=.clang-tidy -p "$1" --checks="$2" \
    --extra-arg=-Wno-unknown-warning-option 2>/dev/null
}

here=$(pwd)
status=0
compiled=$(sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' build/release/compile_commands.json |
  grep -E "^$here/(build/release/)?(parametrize|solver|tools|meshes)/")
# A united text includes sources.
tidy build/release '-clang-analyzer-*,-bugprone-suspicious-include' "$compiled" || status=1

# A configured tree that unites nothing has a command for each source.
cmake --preset lint >/dev/null && sed -i 's|build/lint|build/release|g' build/lint/compile_commands.json || exit 1
# shellcheck disable=SC2086  # one folder a word
sources=$(git ls-files $analyzed | grep '\.cpp$')
tidy build/lint '-bugprone-*,-misc-*,-modernize-*,-performance-*,-readability-*' "$sources" || status=1
exit "$status"
