#!/bin/sh
# Replaces the program by the page's fake server, with the same flags, for writing tests.
# THUNDERHEAD_BINARY=$PWD/fake_program.sh npm test
cd "$(dirname "$0")/../../client-web" && exec node node_modules/vite-node/vite-node.mjs test/fake_server.ts "$@"
