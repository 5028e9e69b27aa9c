#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# clang-tidy by .clang-tidy, over what the preset `release` builds (its generated headers must be there). Its matchers
# read every folder as the one text that it is compiled as. Its path-sensitive analyzer goes file by file, as one long
# text takes it longer, and takes as long as all other checks of the project: without --all it reads only what reads
# foreign files.
# usage: tools/lint.sh [--all]
set -u
cd "$(dirname "$0")/.." || exit 1
case ${1-} in
  "") analyzed="parametrize/src/import solver/asset solver/src/scene" ;;
  --all) analyzed="parametrize solver tools meshes" ;;
  *) echo "usage: tools/lint.sh [--all]" >&2; exit 2 ;;
esac

# tidy FOLDER CHECKS: over the sources on standard input, with the compile commands of a folder; both are GCC's and name
# options that clang does not know.
tidy() {
  xargs -r -n 1 -P "$(nproc)" clang-tidy --quiet --config-file=.clang-tidy -p "$1" --checks="$2" \
    --extra-arg=-Wno-unknown-warning-option 2>/dev/null
}

compiled() { sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' build/release/compile_commands.json; }
here=$(pwd)
status=0
# A united text includes sources.
compiled | grep -E "^$here/(build/release/)?(parametrize|solver|tools|meshes)/" |
  tidy build/release '-clang-analyzer-*,-bugprone-suspicious-include' || status=1

# A configured tree that unites nothing has a command for each source.
cmake --preset lint >/dev/null && sed -i 's|build/lint|build/release|g' build/lint/compile_commands.json || exit 1
# shellcheck disable=SC2086  # one folder a word
git ls-files $analyzed | grep '\.cpp$' |
  tidy build/lint '-bugprone-*,-misc-*,-modernize-*,-performance-*,-readability-*' || status=1
exit "$status"
