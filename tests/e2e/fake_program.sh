#!/bin/sh
# Stands in for the program while the tests are being written: the page's fake server, same flags.
# THUNDERHEAD_BINARY=$PWD/fake_program.sh npm test
cd "$(dirname "$0")/../../client-web" && exec node node_modules/vite-node/vite-node.mjs test/fake_server.ts "$@"
