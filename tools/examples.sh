#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Plays every scene of meshes/scenes and leaves a film, a picture of twelve moments and a report of each in a folder.
# Needs a release build (see tools/demo.sh, which makes one) and ffmpeg.
# usage: tools/examples.sh [FOLDER]        default out/examples
set -eu
cd "$(dirname "$0")/.."
out=${1:-out/examples}
build=${GEOCLOTH_BUILD:-build/release}

mkdir -p "$out"
"$build/meshes/make_meshes" "$out/meshes" > "$out/meshes.log"
cp meshes/scenes/*.json "$out"
for garment in t_shirt cape poncho skirt dress flag cushion dress_pattern; do
  "$build/geocloth" convert "$out/meshes/garments/$garment.obj" -o "$out/$garment.glb" --resolution 64 --quiet
done
for scene in meshes/scenes/*.json; do
  name=$(basename "$scene" .json)
  echo "== $name"
  "$build/geocloth" simulate "$out/$name.json" -o "$out/$name.mp4" --report "$out/$name.report.json" --size 640x360 --quiet
  frames=$(ffprobe -loglevel error -show_entries stream=nb_frames -of csv=p=0 "$out/$name.mp4")
  ffmpeg -y -loglevel error -i "$out/$name.mp4" -frames:v 1 -update 1 \
    -vf "select='not(mod(n\,$((frames / 12))))',scale=480:-1,tile=4x3" "$out/$name.png"
done
