// Tables of pairs: an enumerator of a message and the corresponding value. They are looked up in
// both directions.
#pragma once

namespace thunderhead::service {

// Returns the value paired with `message`. Returns the value of the first row if no row has
// `message`.
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
