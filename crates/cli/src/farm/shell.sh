#!/bin/sh
# {{title}}. Written by `bidir farm shell`.
#
#   sh FILE         renders all parts here, one after the other, and makes the image
#   sh FILE 0 3     renders parts 0 and 3, such as on one of several machines
#   sh FILE merge   makes the image of the parts that exist
#
# A stopped part continues when it is started again; finished parts return at once.
set -eu

render() {
  part=$1
  bidir render {{scene}} --part "$part"/{{parts}}{{spp}} --checkpoint {{share}}"$part"-of-{{parts}}.film --resume{{flags}}
}

merge() {
  {{merge}}
  {{develop}}
}

if [ $# -eq 0 ]; then
  share=0
  while [ "$share" -lt {{parts}} ]; do
    render "$share"
    share=$((share + 1))
  done
  merge
fi
for share; do
  if [ "$share" = merge ]; then merge; else render "$share"; fi
done
