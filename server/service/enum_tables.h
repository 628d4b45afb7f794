// Pairs of a message's enumerator and a value, looked up both ways.
#pragma once

namespace thunderhead::service {

// The value beside `message`; that of the first row if there is none.
template <typename Table, typename Message>
auto ValueOf(const Table& table, Message message) {
  for (const auto& [from, to] : table) {
    if (from == message) return to;
  }
  return table.front().second;
}

template <typename Table, typename Value>
auto MessageOf(const Table& table, Value value) {
  for (const auto& [from, to] : table) {
    if (to == value) return from;
  }
  return table.front().first;
}

}  // namespace thunderhead::service
