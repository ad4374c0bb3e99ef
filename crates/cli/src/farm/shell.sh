#!/bin/sh
# Written by `bidir farm shell`.
#
#   sh FILE         renders all parts here, one after the other, and makes the image
#   sh FILE 0 3     renders parts 0 and 3, such as on one of several machines
#   sh FILE merge   makes the image of the parts that exist
#
# A stopped part continues when it is started again; finished parts return at once.
set -eu
parts={{parts}}
name={{name}}

if [ $# -eq 0 ]; then
  part=0
  while [ "$part" -lt "$parts" ]; do
    set -- "$@" "$part"
    part=$((part + 1))
  done
  set -- "$@" merge
fi
for part; do
  if [ "$part" = merge ]; then
    bidir merge "$name".part-[0-9]*-of-"$parts".film -o "$name.film"
    bidir film develop "$name.film" -o "$name.exr"
  else
    bidir render {{scene}} --part "$part/$parts" --checkpoint "$name.part-$part-of-$parts.film" --resume{{flags}}
  fi
done
