// Wrappers for SQLite's C interface, with automatic release of handles and with absl::Status for
// errors.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

struct sqlite3;
struct sqlite3_stmt;

namespace thunderhead::store {

class Statement;

// Returns DATA_LOSS for a damaged file, with instructions for the operator. `why` is the cause.
absl::Status DamagedFile(const std::string& path, const std::string& why);

class Database {
 public:
  // The path of a new, empty database that is only in memory.
  static constexpr char kInMemory[] = ":memory:";

  // Opens an existing file. A link in its place is not followed.
  static absl::StatusOr<Database> Open(const std::string& path);

  // Executes statements without results.
  absl::Status Execute(const std::string& sql);
  absl::StatusOr<Statement> Prepare(const std::string& sql);
  // Returns the single number that the query yields.
  absl::StatusOr<std::int64_t> Number(const std::string& sql);
  // Returns the error of the last SQLite call: DATA_LOSS for a damaged file, or one whose tables
  // are not those that the SQL names, else UNAVAILABLE.
  absl::Status Error() const;

 private:
  struct Close {
    void operator()(sqlite3* database) const;
  };

  explicit Database(std::string path) : path_(std::move(path)) {}

  std::string path_;
  std::unique_ptr<sqlite3, Close> handle_;
};

// A prepared statement. It can be used again after each Run, or after Next has returned false.
// Parameters count from 1, columns from 0. Bound texts and blobs must live until the Run ends or
// Next has returned false.
class Statement {
 public:
  void Bind(int parameter, std::int64_t value);
  void Bind(int parameter, double value);
  void Bind(int parameter, std::string_view text);
  void BindNull(int parameter);
  void BindBlob(int parameter, std::string_view bytes);

  // Runs a statement without results.
  absl::Status Run();
  // Fetches the next row. Returns false after the last row.
  absl::StatusOr<bool> Next();

  bool IsNull(int column) const;
  std::int64_t Number(int column) const;
  double Real(int column) const;
  std::string Bytes(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };

  Statement(const Database& database, sqlite3_stmt* handle)
      : database_(database), handle_(handle) {}

  const Database& database_;
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

// A transaction that is rolled back unless it is committed.
class Transaction {
 public:
  static absl::StatusOr<Transaction> Begin(Database& database);
  Transaction(Transaction&& other) noexcept;
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  absl::Status Commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  // null if committed
};

}  // namespace thunderhead::store
