// Includes Asio's coroutines. Boost 1.74's awaitable.hpp uses std::exchange without including
// <utility>, so <utility> must come first.
#pragma once

#include <utility>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
