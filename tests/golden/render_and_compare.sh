#!/bin/sh
# render_and_compare.sh PICTURE EXPECTED COMPARE RENDER...: runs RENDER... -o PICTURE, then COMPARE EXPECTED PICTURE DIFFERENCE.
set -e
picture=$1 expected=$2 compare=$3
shift 3
mkdir -p "$(dirname "$picture")"
"$@" -o "$picture"
exec "$compare" "$expected" "$picture" "${picture%.png}.difference.png"
