#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# All checks, from a fresh clone on Debian 12: installs what is missing, builds with warnings as errors, runs every test,
# runs what reads foreign files and much of the solver again under the address and undefined-behaviour sanitizers, checks
# format and lint.
# The last line is `N passed, N failed`; the exit status says the same.
set -u
cd "$(dirname "$0")/.." || exit 1

tools/install_packages.sh test || exit 1
export GEOCLOTH_REQUIRE_DEVICE=1 CTEST_OUTPUT_ON_FAILURE=1
jobs=$(nproc)
passed=0
failed=0

# check NAME COMMAND...: one check that is not a test program's.
check() {
  echo "== $1"
  name=$1
  shift
  if "$@"; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED: $name"; fi
}

# count_tests FOLDER ARGUMENTS...: runs ctest and adds up its cases.
count_tests() {
  folder=$1
  shift
  rm -f "$folder/junit.xml"
  ctest --test-dir "$folder" -j "$jobs" --output-junit junit.xml --no-tests=error "$@"
  status=$?
  # <testsuite ... tests="12" failures="1" disabled="0" skipped="2" ...>
  suite=$(tr '\n' ' ' <"$folder/junit.xml" 2>/dev/null | sed -n 's/.*<testsuite \([^>]*\)>.*/\1/p')
  if [ -z "$suite" ]; then
    echo "FAILED: no tests ran in $folder"
    failed=$((failed + 1))
    return
  fi
  number() { printf '%s' "$suite" | sed -n "s/.*[[:space:]]$1=\"\([0-9]*\)\".*/\1/p"; }
  tests=$(number tests) failures=$(number failures) skipped=$(number skipped) disabled=$(number disabled)
  passed=$((passed + tests - failures - skipped - disabled))
  # A test program that was not built counts as skipped, but ctest fails.
  if [ "$status" != 0 ] && [ "$failures" = 0 ]; then failures=1; fi
  failed=$((failed + failures))
}

build() { cmake --preset "$1" && cmake --build --preset "$@"; }

own_sources() { git ls-files '*.cpp' '*.h'; }
format_holds() { own_sources | xargs -r clang-format --dry-run --Werror; }

check "build release" build release
check "clang-format" format_holds
count_tests build/release
# Of the solver those tests that are quick even so.
solver_tests=$(printf ' solver_%s_test' adding bending colliders cutting deforming fabrics lines motion random_scenes rough scene scene_bodies sleeping state)
# shellcheck disable=SC2086  # one target a word
check "build sanitize" build sanitize \
  --target tests/asset/all tests/fuzz/all tests/parametrize/all $solver_tests program_test
# Not what only compares results, plays what others do for longer, or converts a larger mesh as others do: its code is
# that of the tests beside it. Of the shared meshes the irregular ones go all the way, of the garments three, and all of
# them as far as the repair.
# (CMake's regular expressions have room for nine groups, and ctest leaves out nothing where there are more.)
compares="Invariance|(Convert|Holes|PartPanels|Quality)[.].*(TheSame|DoesNotDepend)"
longer="TimeStep[.]OfAnyGame|FarFromTheStart|FreeFall[.]FromHigh|Bending[.]StiffClothOverABall"
larger="Develop[.]WhatWants|Holes[.]Of(ABallThat|AShirts)|SmallPieces[.](WhatDoesNot|ANetOf)|Layers[.]AShirt|Layers[.]OfAThickTube|ConvertReport[.](SaysWhatMakes|Narrow|NamesAVertexThatIsLost)"
shared="All/SharedMesh[.].*/(garments|bodies)_|Garments/.*/(diffcloth_d|newton_u|codimipc_c).*_panels|UvLayout[.]Shared"
count_tests build/sanitize -L '^(asset|parametrize|fuzz|solver)$' -E "^($compares|$longer|$larger|$shared)|_NOT_BUILT\$"
# Not where a Vulkan driver is loaded: Mesa's leaks a little when it is unloaded.
count_tests build/sanitize -L '^unit$' -R '^(Convert|Inspect|Simulate)[/.]' -E '^Simulate\.UnknownDevice'
check "clang-tidy" tools/lint.sh

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
