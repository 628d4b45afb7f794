// Tables of pairs (enumerator of a message, value), looked up in both directions.
#pragma once

namespace thunderhead::service {

// Returns the value paired with `message`, or that of the first row if there is none.
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
